"""One HTML page about an evaluation that needs nothing but itself: ``polyfold report``."""

from polyfold.report.page import report_html, write_report

__all__ = ["report_html", "write_report"]
