#!/usr/bin/env python3
"""Makes the three subset fonts of the figures from Source Sans 3 (SIL Open Font License 1.1, OFL.txt here).

    pip install fonttools fontpkg-source-sans-3
    python subset.py <folder of SourceSans3[wght].ttf and SourceSans3-Italic[wght].ttf>

Keeps Latin, Greek and the signs that axis labels need, fixes the weight, and flattens pair kerning into a plain
`kern` table. The name "Source" is reserved by the license, so the subset is called Flow Figure Sans.
"""
import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTFont, newTable
from fontTools.ttLib.tables._k_e_r_n import KernTable_format_0
from fontTools.varLib.instancer import instantiateVariableFont

RANGES = [(0x20, 0x7E), (0xA0, 0x17F), (0x391, 0x3A9), (0x3B1, 0x3C9), (0x3D1, 0x3D1), (0x3D5, 0x3D5)]
SIGNS = "–—‘’“”•…′″‰⁰⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉₋←↑→↓∂∆∏∑−√∞∫≈≠≤≥◊ℓ"
KERNED = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.,-–−/()%αβγδεθκλμνρστφχψωΓΔΣΦΨΩ"
FACES = [("SourceSans3[wght].ttf", 400, "regular"), ("SourceSans3-Italic[wght].ttf", 400, "italic"),
         ("SourceSans3[wght].ttf", 600, "semibold")]


def pair_kerning(font, glyphs):
    """First matching horizontal advance adjustment of each pair, in lookup order, as a layout engine applies it."""
    gpos = font["GPOS"].table
    kern = next(f.Feature for f in gpos.FeatureList.FeatureRecord if f.FeatureTag == "kern")
    pairs = {}
    for number in kern.LookupListIndex:
        for table in gpos.LookupList.Lookup[number].SubTable:
            table = getattr(table, "ExtSubTable", table)
            if table.LookupType != 2:
                continue
            covered = [g for g in table.Coverage.glyphs if g in glyphs]
            for left in covered:
                if table.Format == 1:
                    records = table.PairSet[table.Coverage.glyphs.index(left)].PairValueRecord
                    found = {r.SecondGlyph: r.Value1 for r in records if r.SecondGlyph in glyphs}
                else:
                    row = table.Class1Record[table.ClassDef1.classDefs.get(left, 0)].Class2Record
                    found = {g: row[table.ClassDef2.classDefs.get(g, 0)].Value1 for g in glyphs}
                for right, value in found.items():
                    pairs.setdefault((left, right), getattr(value, "XAdvance", 0) or 0)
    return {pair: value for pair, value in pairs.items() if value}


def make(source, weight, name):
    font = TTFont(source)
    instantiateVariableFont(font, {"wght": weight}, inplace=True)
    characters = [c for low, high in RANGES for c in range(low, high + 1)] + [ord(c) for c in SIGNS]
    options = subset.Options()
    options.layout_features = ["kern"]
    options.hinting = False
    options.name_IDs = [0, 1, 2, 13, 14]
    options.notdef_outline = True
    options.drop_tables += ["DSIG", "STAT", "GDEF", "GSUB"]
    worker = subset.Subsetter(options)
    worker.populate(unicodes=characters)
    worker.subset(font)
    best = font.getBestCmap()
    missing = [chr(c) for c in characters if c not in best and not 0xA0 <= c <= 0x17F]
    print(name, "missing:", "".join(missing))
    table = KernTable_format_0()
    table.version, table.coverage, table.apple = 0, 1, False
    table.kernTable = pair_kerning(font, {best[ord(c)] for c in KERNED if ord(c) in best})
    font["kern"] = newTable("kern")
    font["kern"].version, font["kern"].kernTables = 0, [table]
    del font["GPOS"]
    for record in font["name"].names:
        if record.nameID == 1:
            record.string = "Flow Figure Sans"
        if record.nameID == 2:
            record.string = name
    font["head"].created = font["head"].modified = 0
    font.recalcTimestamp = False
    out = Path(__file__).parent / f"{name}.ttf"
    font.save(out)
    print(out.name, out.stat().st_size, "bytes", len(table.kernTable), "kerning pairs")


for file, weight, name in FACES:
    make(Path(sys.argv[1]) / file, weight, name)
