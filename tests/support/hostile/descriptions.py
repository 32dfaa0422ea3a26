"""FMUs whose modelDescription.xml is sloppy, wrong or hostile."""

from __future__ import annotations

from collections.abc import Callable

from support.hostile.case import WHOLE, Case, Entries, Mutation


def described(name: str, what: str, expected: str, *changes: tuple[str, str], **more: object) -> Case:
    """A case whose description is refused."""
    return Case(name, what, expected, None, changes=changes, **more)  # type: ignore[arg-type] # fields of Case


def borne(name: str, what: str, expected: str, *changes: tuple[str, str], **more: object) -> Case:
    """A case whose description is sloppy, and borne."""
    return Case(name, what, expected, WHOLE, changes=changes, **more)  # type: ignore[arg-type] # as above


def other_xml(change: Callable[[bytes], bytes]) -> Mutation:
    """Entries whose description has its bytes changed."""

    def mutate(entries: Entries, fmi: int) -> Entries:
        return entries | {"modelDescription.xml": change(entries["modelDescription.xml"])}

    return mutate


def in_encoding(name: str, written: str | None = None) -> Mutation:
    """A description in an encoding, which it names, or says to be the one that is `written`."""

    def change(xml: bytes) -> bytes:
        text = xml.decode().replace("UTF-8", written or name)
        return text.replace('modelName="Hostile"', 'modelName="Fährrad"').encode(name)

    return other_xml(change)


def many_variables(count: int) -> Mutation:
    """A description with so many variables more."""

    def mutate(entries: Entries, fmi: int) -> Entries:
        about = [f'name="p[{i}]" valueReference="{i + 100}"' for i in range(count)]
        element = "<Float64 {}/>" if fmi == 3 else "<ScalarVariable {}><Real/></ScalarVariable>"
        end = b"</ModelVariables>"
        lines = "\n".join(element.format(each) for each in about).encode()
        return entries | {"modelDescription.xml": entries["modelDescription.xml"].replace(end, lines + end)}

    return mutate


_DOC = "<!DOCTYPE fmiModelDescription [{}]>\n<fmiModelDescription"
_LAUGHS = '<!ENTITY a0 "ha">' + "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 10))
DESCRIPTIONS = [
    borne("units_missing", "declares no units of measure", "bad.y declares no unit", (' unit="m/s"', "")),
    borne("unit_undefined", 'unit="km/h" without a definition', "", (' unit="m/s"', ' unit="km/h"')),
    described(
        "unit_unknown", "a unit of measure that nobody knows", "floops", (' unit="m/s"', ' unit="floops"')
    ),
    borne("locals_only", "no outputs, only locals", "", ('"output"', '"local"'), exact=False),
    borne(
        "locals_mapped",
        "the same with another name",
        "",
        ('"output"', '"local"'),
        ('name="y"', 'name="v"'),
        entry='map.outputs.y = "v"',
    ),
    borne(
        "start_of_wrong_type",
        "a start value that is no number",
        "u: start = 'off' is no",
        ('start="0"', 'start="off"'),
    ),
    borne(
        "limit_of_wrong_type",
        "a minimum that is no number",
        "min = '-' is no",
        ('causality="output" unit', 'causality="output" min="-" unit'),
        versions=(3,),
    ),
    borne(
        "variability_wrong",
        "a parameter that is continuous",
        "gain: a parameter of variability",
        ('variability="fixed"', 'variability="continuous"'),
    ),
    borne(
        "type_undefined",
        "a declared type that is not defined",
        "declaredType 'Nowhere' is not defined",
        (' unit="m/s"', ' declaredType="Nowhere"'),
    ),
    borne(
        "unknown_out_of_range",
        "an output with an index that there is not",
        "'99' is the index of none",
        ('index="2"', 'index="99"'),
        versions=(2,),
    ),
    borne(
        "unknown_out_of_range",
        "an output with a value reference that there is not",
        "99",
        ('Output valueReference="1"', 'Output valueReference="99"'),
        versions=(3,),
    ),
    borne(
        "unknown_of_nonsense",
        "an output with an index that is no number",
        "'x' is the index of none",
        ('index="2"', 'index="x"'),
        versions=(2,),
    ),
    borne(
        "structure_missing",
        "no ModelStructure",
        "",
        ("<ModelStructure>", "<Strukture>"),
        ("</ModelStructure>", "</Strukture>"),
    ),
    borne(
        "initial_unknowns_wrong",
        "InitialUnknowns that name what there is not",
        "'77' is the index of none of 6 variables; it is left out",
        (
            "</Outputs>",
            '</Outputs><InitialUnknowns><Unknown index="1"/><Unknown index="77"/></InitialUnknowns>',
        ),
        versions=(2,),
    ),
    borne(
        "states_declared",
        "says that it saves its state, and cannot",
        "",
        (
            'modelIdentifier="hostile"',
            'modelIdentifier="hostile" canGetAndSetFMUstate="true" canGetAndSetFMUState="true"',
        ),
    ),
    borne(
        "capability_of_nonsense",
        "a capability that is neither true nor false",
        "maxOutputDerivativeOrder = 'many' is no number; it is ignored",
        (
            'modelIdentifier="hostile"',
            'modelIdentifier="hostile" maxOutputDerivativeOrder="many" canInterpolateInputs="perhaps"',
        ),
    ),
    borne(
        "experiment_of_nonsense",
        "a default experiment of negative steps and no numbers",
        "startTime = 'x' is no finite number; it is ignored",
        (
            "<ModelVariables>",
            '<DefaultExperiment startTime="x" stopTime="-1" stepSize="-0.01"/><ModelVariables>',
        ),
    ),
    borne(
        "min_above_max",
        "a minimum above the maximum",
        "u: min = 5 is above max = -5; both are ignored",
        ('start="0"', 'start="0" min="5" max="-5"'),
    ),
    borne(
        "start_out_of_range",
        "a start value above the maximum",
        "gain: start = 1 is above max = -5",
        ('start="1"', 'start="1" max="-5"'),
    ),
    borne(
        "enumeration_without_items",
        "an enumeration without items",
        "",
        ("<Integer/>", "<Enumeration/>"),
        versions=(2,),
    ),
    described(
        "lacks_getter",
        "a variable of a type that the library has no function for",
        "lacks the function fmi3GetInt64",
        ('<Int32 name="n"', '<Enumeration name="n"'),
        versions=(3,),
    ),
    borne(
        "references_shared",
        "two variables with one value reference",
        "",
        ('valueReference="4"', 'valueReference="1"'),
    ),
    described(
        "reference_negative",
        "a negative value reference",
        "valueReference '-1'; a whole number",
        ('name="y" valueReference="1"', 'name="y" valueReference="-1"'),
    ),
    described(
        "reference_huge",
        "a value reference above 2^32",
        "valueReference '99999999999'",
        ('name="y" valueReference="1"', 'name="y" valueReference="99999999999"'),
    ),
    described(
        "name_twice",
        "two variables with one name",
        "variable 'y' … is declared twice",
        ('name="b"', 'name="y"'),
    ),
    borne(
        "name_missing",
        "a variable without a name",
        "a variable without a name is left out",
        ('name="s" ', ""),
    ),
    borne(
        "names_that_break_tables",
        "names with commas, quotes and line ends",
        "",
        ('name="n"', 'name="n,&quot;&#10;=1+1"'),
    ),
    described(
        "loop_of_itself",
        "an output that is its own input, and depends on it",
        "algebraic loop",
        ('<Unknown index="2" dependencies=""/>', '<Unknown index="2" dependencies="1"/>'),
        entry='[[connect]]\nfrom = "bad.y"\nto = ["bad.u"]',
        versions=(2,),
    ),
    described(
        "version_unknown",
        "FMI 4.0",
        "fmiVersion is '4.0'; 1.0, 2.0, 3.0 are supported",
        ('fmiVersion="2.0"', 'fmiVersion="4.0"'),
        versions=(2,),
    ),
    described(
        "version_missing", "no fmiVersion", "fmiVersion is None", ('fmiVersion="2.0" ', ""), versions=(2,)
    ),
    described(
        "root_wrong",
        "another document",
        "begins with <html>, not with <fmiModelDescription>",
        ("fmiModelDescription", "html"),
        versions=(2,),
    ),
    described(
        "not_well_formed",
        "an element that is not closed",
        "no well-formed XML",
        ("</ModelVariables>", ""),
        versions=(2,),
    ),
    described(
        "no_variables",
        "no ModelVariables",
        "has no <ModelVariables>",
        ("ModelVariables", "Variables"),
        versions=(2,),
    ),
    described(
        "deep",
        "a thousand nested elements",
        "no well-formed XML",
        ("<ModelVariables>", "<a>" * 1000 + "</a>" * 1000 + "<ModelVariables>"),
    ),
    described(
        "entity_file",
        "an external entity",
        "has a document type",
        ("<fmiModelDescription", _DOC.format('<!ENTITY a SYSTEM "file:///etc/passwd">')),
        ("Hostile", "&a;"),
    ),
    described(
        "entity_bomb",
        "entities that expand to a billion laughs",
        "has a document type",
        ("<fmiModelDescription", _DOC.format(_LAUGHS)),
        ("Hostile", "&a9;"),
    ),
    described(
        "identifier_outside",
        "a modelIdentifier with ../",
        "modelIdentifier is '../../evil', which is no plain name",
        ('modelIdentifier="hostile"', 'modelIdentifier="../../evil"'),
        versions=(1, 2, 3),
    ),
    described(
        "identifier_missing",
        "no modelIdentifier",
        "modelIdentifier",
        (' modelIdentifier="hostile"', ""),
        versions=(2, 3),
    ),
    described(
        "identifier_other",
        "a modelIdentifier that is not the library's",
        "binaries/…/other.so is missing",
        ('modelIdentifier="hostile"', 'modelIdentifier="other"'),
    ),
    described(
        "no_interface",
        "neither Co-Simulation nor Model Exchange",
        "has neither a Co-Simulation nor a Model Exchange interface",
        ('<CoSimulation modelIdentifier="hostile"/>', ""),
    ),
    described(
        "model_exchange",
        "Model Exchange only, by a library without it",
        "lacks the function fmi",
        ("<CoSimulation ", "<ModelExchange "),
    ),
    described(
        "needs_tool",
        "needs a tool that is not there",
        "cannot be instantiated: it needs the tool that made it (ACME)",
        ('modelIdentifier="hostile"', 'modelIdentifier="hostile" needsExecutionTool="true"'),
        ("modelName=", 'generationTool="ACME" modelName='),
        act="instantiate_silent",
    ),
    borne("utf16", "UTF-16", "", mutate=in_encoding("UTF-16")),
    borne("latin1", "ISO-8859-1, which it says", "", mutate=in_encoding("ISO-8859-1")),
    described(
        "latin1_as_utf8",
        "ISO-8859-1 that says UTF-8",
        "no well-formed XML",
        mutate=in_encoding("ISO-8859-1", "UTF-8"),
    ),
    borne("bom", "a byte order mark", "", mutate=other_xml(lambda xml: b"\xef\xbb\xbf" + xml)),
    described(
        "encoding_unknown", "an encoding that there is not", "no well-formed XML", ("UTF-8", "KLINGON")
    ),
    described(
        "empty_description", "an empty description", "no well-formed XML", mutate=other_xml(lambda xml: b"")
    ),
    borne("many_variables", "10 000 variables", "", mutate=many_variables(10_000)),
]
