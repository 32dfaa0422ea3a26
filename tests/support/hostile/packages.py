"""FMUs whose archive or library file is damaged, incomplete or hostile."""

from __future__ import annotations

import dataclasses

from support.hostile import archives, elf
from support.hostile.case import WHOLE, Case
from support.hostile.units import binary

_XML = "modelDescription.xml"
_OUTSIDE = "would be written outside the FMU's folder"
_PACKED = [
    Case("empty_file", "no bytes", "the file is empty", None, pack=archives.of_bytes(lambda b: b"")),
    Case(
        "text_file",
        "no archive",
        "it is no zip archive",
        None,
        pack=archives.of_bytes(lambda b: b"hello\n" * 100),
    ),
    Case(
        "truncated",
        "the first half of an archive",
        "truncated",
        None,
        pack=archives.of_bytes(lambda b: b[: len(b) // 2]),
    ),
    Case(
        "truncated_end", "without its last bytes", "truncated", None, pack=archives.of_bytes(lambda b: b[:-5])
    ),
    Case(
        "wrong_checksum",
        "a wrong checksum",
        "cannot be read: Bad CRC-32",
        None,
        pack=archives.of_bytes(archives.wrong_checksum),
    ),
    Case("encrypted", "an encrypted entry", "is encrypted", None, pack=archives.of_bytes(archives.encrypted)),
    Case(
        "method",
        "a compression that nobody knows",
        "cannot be read: That compression method",
        None,
        pack=archives.method(97),
    ),
    Case(
        "lying",
        "an entry that is larger than it says",
        "modelDescription.xml",
        None,
        pack=archives.lying_about_size,
    ),
    Case(
        "overlapping",
        "two entries on the same bytes",
        "cannot be extracted: File name in directory…differ",
        None,
        pack=archives.overlapping,
    ),
    Case(
        "no_description",
        "an archive of something else",
        "it has no modelDescription.xml",
        None,
        mutate=lambda e, fmi: {"readme.txt": b"x"},
    ),
    Case(
        "in_a_folder",
        "everything one folder deeper",
        "it has no modelDescription.xml…Hostile/",
        None,
        pack=archives.in_a_folder,
    ),
    Case("no_entries", "an empty archive", "it has no modelDescription.xml", None, mutate=lambda e, fmi: {}),
    Case(
        "bomb",
        "a bomb: 100 MB in 100 kB",
        "unpacks to … times its size, more than 500",
        None,
        pack=archives.bomb,
    ),
    Case(
        "entries",
        "25 000 entries",
        "has 25002 entries, more than 20000",
        None,
        pack=archives.with_entries(25_000),
    ),
    Case("outside", "an entry ../../evil", _OUTSIDE, None, pack=archives.with_entry("../../evil")),
    Case("absolute", "an entry /evil", _OUTSIDE, None, pack=archives.with_entry("/evil")),
    Case("drive", "an entry C:/evil", _OUTSIDE, None, pack=archives.with_entry("C:/evil")),
    Case("link", "a link to /etc", "is a link or a device", None, pack=archives.link("resources/etc")),
    Case(
        "device",
        "a device",
        "is a link or a device",
        None,
        pack=archives.with_entry("resources/null", b"", 0o020666),
    ),
    Case("twice", "an entry that is there twice", "are the same file", None, pack=archives.with_entry(_XML)),
    Case(
        "case",
        "entries that differ in case alone",
        "are the same file",
        None,
        pack=archives.with_entry("MODELDESCRIPTION.xml"),
    ),
    Case(
        "file_and_folder",
        "an entry that is a file and a folder",
        "resources",
        None,
        pack=archives.with_entry("modelDescription.xml/resources"),
    ),
    Case(
        "name_too_long",
        "a name of 300 characters",
        "too long",
        None,
        pack=archives.with_entry("resources/" + "x" * 300),
    ),
    Case(
        "path_too_deep",
        "a path of 3000 folders",
        "has a name that is too long",
        None,
        pack=archives.with_entry("a/" * 3000 + "x"),
    ),
    Case(
        "device_name",
        "a name that is a device in Windows",
        "",
        WHOLE,
        pack=archives.with_entry("resources/NUL.txt"),
    ),
    Case(
        "large_description",
        "a description of 65 MiB",
        "has more than 64 MiB",
        None,
        pack=archives.large_description,
        versions=(2,),
    ),
]
ARCHIVES = [dataclasses.replace(case, versions=(2 + i % 2,)) for i, case in enumerate(_PACKED)]
"""One version of FMI for each: an archive is judged before its description is read."""
LIBRARIES = [
    Case(
        "win64_only",
        "a library for Windows alone",
        "has no binary for this machine…it has binaries for win64",
        None,
        mutate=lambda e, fmi: {_XML: e[_XML], "binaries/win64/hostile.dll": b"MZ"},
    ),
    Case(
        "sources_only",
        "sources alone",
        "no binary for this machine…",
        None,
        mutate=lambda e, fmi: {_XML: e[_XML], "sources/hostile.c": b"int x;"},
    ),
    Case(
        "library_is_a_folder",
        "a folder in the place of the library",
        "is missing",
        None,
        mutate=lambda e, fmi: {_XML: e[_XML], binary(fmi) + "/x": b""},
    ),
    Case(
        "library_other_machine",
        "a library for another machine",
        "it is for aarch64",
        None,
        mutate=elf.library(elf.for_another_machine),
    ),
    Case(
        "library_for_windows",
        "a DLL in the folder of Linux",
        "its library cannot be loaded…Windows",
        None,
        mutate=elf.library(elf.for_windows),
    ),
    Case(
        "library_empty",
        "an empty library",
        "its library cannot be loaded…empty",
        None,
        mutate=elf.library(elf.nothing),
    ),
    Case("library_cut", "half a library", "its library cannot be loaded", None, mutate=elf.library(elf.cut)),
    Case(
        "library_needs",
        "a library that needs one that is not there",
        "libq.so.6: cannot open shared object file",
        None,
        mutate=elf.library(elf.without_its_dependency),
    ),
    Case(
        "lacks_step",
        "the library lacks doStep",
        "lacks the function…DoStep",
        None,
        mutate=elf.without("DoStep"),
    ),
    Case(
        "lacks_terminate",
        "the library lacks terminate",
        "unit 'bad' gave 1 warning",
        WHOLE,
        mutate=elf.without("Terminate"),
    ),
    Case("lacks_free", "the library lacks freeInstance", "", WHOLE, mutate=elf.without("FreeInstance")),
]
