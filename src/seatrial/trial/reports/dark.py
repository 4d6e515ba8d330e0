"""Colours of figures for dark pages: what each colour that figures are written in becomes."""

from __future__ import annotations

DARK = {
    "#0b6ea8": "#58b4ea",
    "#d1690e": "#f2a154",
    "#3a8f5c": "#6fcf97",
    "#8a4fa3": "#c792df",
    "#8c6d31": "#d9b66b",
    "#4a5a68": "#b3c1cc",
    "#1f7a4d": "#5cc58d",
    "#b3261e": "#ff8a80",
    "#a15c00": "#e8a84a",
    "#5b6770": "#a3b0ba",
    "#1d2730": "#e6ebef",
    "#9aa5af": "#6b7883",
    "#b4bdc5": "#6b7883",
    "#c9d1d8": "#4a5862",
    "#e6eaee": "#2e3a43",
    "#f1f4f7": "#26323b",
    "#ffffff": "#182128",
}
"""Names of CSS custom properties are not known to Plotly: it draws with what it is given."""
