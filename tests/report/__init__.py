import pytest

pytest.register_assert_rewrite("tests.report.any_page")  # shared by the modules of several pages
