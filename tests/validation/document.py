"""docs/validation.md: tables and plots of all cases, from the rows and the kept results."""
import importlib

from rows import markdown_table

HEAD = """# Validation

How well corpuscle agrees with theory, experiment and other methods. Written by

```sh
./dev validate --document docs/validation.md
```

which runs every simulation once (results stay in the build folder), prints the same rows with pass or fail, and fails if one of them does. A case is a module in `tests/validation/cases/`; how to add one:
[developer/guide.md](developer/guide.md). "error" is ours over reference minus one; "± " the error of ours by itself (statistics, extrapolation). Run times are core seconds, one thread a simulation.
"""


def write_document(path, names, rows, run):
    """Writes the document and, beside it, figures/validation_*.png."""
    figures = path.parent / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    failed = sum(not row.passed for row in rows)
    parts = [HEAD, f"{len(rows) - failed} of {len(rows)} rows pass.\n"]
    for name in names:
        module = importlib.import_module(name)
        mine = [row for row in rows if row.case == name]
        if not mine:
            continue
        parts.append(f"## {getattr(module, 'TITLE', name)}\n\n{getattr(module, 'ABOUT', '').strip()}\n\n{markdown_table(mine)}\n".replace("\n\n\n", "\n"))
        for picture, caption in module.figures(run, figures) if hasattr(module, "figures") else []:
            parts.append(f"![{caption}](figures/{picture})\n\n{caption}\n")
    path.write_text("\n".join(parts))
