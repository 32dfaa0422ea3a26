"""Assertions on what a command line answered."""

from __future__ import annotations


def refused(answer, *texts):
    """Bad input: exit code 2, each text in the message, nothing on stdout."""
    assert answer.code == 2, answer
    assert answer.out == ""
    for text in texts:
        assert text in answer.err, answer.err
    return answer
