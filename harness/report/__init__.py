"""Reports: one self-contained HTML file each, that opens offline and prints.

`page.render_page` makes a page of any `Section`s; `comparison.render_comparison` makes the one of `harness run` from a
`Study`, `diagnosis.render_diagnosis` that of `harness diagnose`. A section is one module with one template; the order
of a report's sections stands in its registry.
"""
