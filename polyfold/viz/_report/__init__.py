"""One HTML page about an evaluation that needs nothing but itself: ``polyfold report``."""

from polyfold.viz._report._page import report_html as report_html
from polyfold.viz._report._page import write_report as write_report
