"""Expectations of a test script that goes on after one has failed, so that all are told."""
import sys

failures = []


def expect(condition, message):
    if not condition:
        failures.append(message)
        print("FAILED", message)


def finish():
    """Ends the script with an error when an expectation has failed."""
    if failures:
        sys.exit(f"{len(failures)} checks failed")
