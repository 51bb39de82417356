"""docs/validation.md: tables and plots of all cases, from the rows and the kept results."""

import importlib

from rows import markdown_table

HEAD = """# Validation

How well corpuscle agrees with theory, experiment and other methods. Written by

```sh
./dev validate --document docs/validation.md
```

which runs every simulation once (results stay in the build folder), prints the same rows with pass or fail, and fails
if one of them does. A case is a module in `tests/validation/cases/`; how to add one: [developer/guide.md](developer/guide.md).

"error" is ours over the reference minus one, "±" the error of ours by itself (statistics, extrapolation). Run times are
core seconds, one thread a simulation, on a machine that was not idle.
"""


def write_document(path, names, rows, run):
    """Writes the document and, beside it, figures/validation_*.png."""
    figures = path.parent / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    failed = [row for row in rows if not row.passed]
    parts = [
        HEAD,
        f"{len(rows) - len(failed)} of {len(rows)} rows pass; all simulations together took {run.total_seconds() / 60:.0f} core minutes.\n",
    ]
    if failed:
        parts.append("Rows that fail: " + "; ".join(f"{row.case}: {row.quantity}" for row in failed) + ".\n")
    for name in names:
        module = importlib.import_module(name)
        mine = [row for row in rows if row.case == name]
        if not mine:
            continue
        parts.append(f"## {getattr(module, 'TITLE', name)}\n")
        parts.append(getattr(module, "ABOUT", "").strip() + "\n")
        parts.append(markdown_table(mine) + "\n")
        for picture, caption in module.figures(run, figures) if hasattr(module, "figures") else []:
            parts.append(f"![{caption}](figures/{picture})\n\n{caption}\n")
    path.write_text("\n".join(parts))
