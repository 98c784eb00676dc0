"""Reports as self-contained HTML files that can be opened offline and printed.

`page.render_page` renders `Section`s; `comparison.render_comparison` makes the report of `harness run` from a `Study`,
`diagnosis.render_diagnosis` that of `harness diagnose`. Each section is one module with one template; `SECTIONS` of
each report defines their order.
"""
