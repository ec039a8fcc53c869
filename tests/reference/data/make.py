"""Writes runs.xlsx and runs.ods: workbooks of two sheets, as a spreadsheet program would.

python3 make.py (pandas with openpyxl and odfpy)
"""
import pandas as pd

runs = pd.DataFrame({'probe': ['A1', 'A2', 'A3'], 'UCS (MPa)': [35.25, 30.125, None], 'E/GPa': [28, 29.5, 31]})
for name, engine in (('runs.xlsx', 'openpyxl'), ('runs.ods', 'odf')):
    with pd.ExcelWriter(name, engine=engine) as book:
        pd.DataFrame({'remark': ['made for tests']}).to_excel(book, sheet_name='remarks', index=False)
        runs.to_excel(book, sheet_name='cylinders', index=False)
