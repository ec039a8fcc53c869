//! Tables as CSV, LaTeX (booktabs) and Markdown from columns. Symbols and units are in the heads. Texts are escaped for
//! each format ([`super::escape`]); captions and notes may hold mathematics between dollar signs.

use super::column::{Column, Digits, Values};
use super::escape;
use super::text::{is_compound, unit_parts};
use std::collections::BTreeMap;

/// A table with caption and note.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Caption; may be empty.
    pub caption: String,
    /// Label for references in LaTeX; may be empty.
    pub label: String,
    /// Columns of equal length.
    pub columns: Vec<Column>,
    /// Note under the table.
    pub notes: Vec<String>,
    /// Symbols of names that cells of some columns hold.
    pub symbols: Symbols,
}

/// Symbols of the names that stand in cells, alone or in products of powers such as `mu^2*Ec`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Symbols {
    /// Symbols by name, in the notation of LaTeX without dollar signs.
    pub of: BTreeMap<String, String>,
    /// Keys of the columns that hold names.
    pub columns: &'static [&'static str],
}

impl Symbols {
    /// The symbol of a column, and what its key says beside the name: ` published` of `UCS published`.
    fn head<'a>(&'a self, column: &'a Column) -> Option<(&'a str, &'a str)> {
        if !column.symbol.is_empty() {
            return Some((&column.symbol, ""));
        }
        let at = column.key.find(' ')?;
        let (name, word) = column.key.split_at(at);
        self.of.get(name).map(|symbol| (symbol.as_str(), word))
    }

    /// A cell as mathematics; nothing of a cell that holds anything but names with symbols.
    fn cell(&self, column: &Column, text: &str) -> Option<String> {
        if !self.columns.contains(&column.key.as_str()) {
            return None;
        }
        let part = |part: &str| {
            let (name, power) = part.split_once('^').map_or((part, None), |(name, power)| (name, Some(power)));
            let symbol = self.of.get(name.trim())?;
            let Some(power) = power else { return Some(symbol.clone()) };
            let is_number = power.bytes().all(|b| b.is_ascii_digit()) && !power.is_empty();
            let base = if is_compound(symbol) { format!("({symbol})") } else { symbol.clone() };
            is_number.then(|| format!("{base}^{{{power}}}"))
        };
        let parts = text.split('*').map(part).collect::<Option<Vec<String>>>()?;
        Some(format!("${}$", parts.join(r" \cdot ")))
    }
}

/// All digits, one head row `key [unit]`, RFC 4180 quoting, lines end with a newline.
pub fn csv(columns: &[Column]) -> String {
    let head = columns
        .iter()
        .map(|c| escape::csv(&if c.unit.is_empty() { c.key.clone() } else { format!("{} [{}]", c.key, c.unit) }));
    let mut out = head.collect::<Vec<_>>().join(",") + "\n";
    let alone = columns.len() == 1;
    for row in 0..rows(columns) {
        let cells = columns.iter().map(|c| escape::csv(&exact(c, row)));
        let line = cells.collect::<Vec<_>>().join(",");
        // An empty line would not be read as a row.
        out += if alone && line.is_empty() { "\"\"" } else { &line };
        out.push('\n');
    }
    out
}

fn rows(columns: &[Column]) -> usize {
    columns.iter().map(Column::len).max().unwrap_or(0)
}

/// A cell with all digits; empty when missing.
fn exact(column: &Column, row: usize) -> String {
    match &column.values {
        Values::Reals(v) => v.get(row).filter(|x| x.is_finite()).map(|&x| lossless(x)).unwrap_or_default(),
        Values::Whole(v) => v.get(row).map(i64::to_string).unwrap_or_default(),
        Values::Words(v) => v.get(row).cloned().unwrap_or_default(),
    }
}

/// The shortest text that reads back as the same number; with an exponent when very small or large.
fn lossless(x: f64) -> String {
    if x != 0.0 && !(1e-5..1e15).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}

/// A cell for people, with a hyphen for minus; `None` when missing.
pub fn shown(column: &Column, row: usize) -> Option<String> {
    let Values::Reals(v) = &column.values else { return Some(exact(column, row)).filter(|c| !c.is_empty()) };
    let x = *v.get(row)?;
    if !x.is_finite() {
        return None;
    }
    Some(match column.digits {
        Digits::Shortest => lossless(x),
        Digits::Fixed(n) => unsigned_zero(format!("{x:.n$}")),
        Digits::Unlike(_) if x.fract() == 0.0 && x.abs() < 1e7 => lossless(x),
        Digits::Significant(n) | Digits::Unlike(n) => significant(x, n),
    })
}

/// `1.234e-7` beyond ten-thousandths and millions, else plain.
fn significant(x: f64, digits: usize) -> String {
    let digits = digits.max(1);
    let rounded = format!("{x:.*e}", digits - 1);
    let exponent: i32 = rounded.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if x != 0.0 && !(-4..7).contains(&exponent) {
        return rounded;
    }
    unsigned_zero(format!("{x:.*}", (digits as i32 - 1 - exponent).max(0) as usize))
}

fn unsigned_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.into(),
        _ => text,
    }
}

impl Table {
    /// A `table` environment with booktabs rules.
    pub fn latex(&self) -> String {
        let align: String =
            self.columns.iter().map(|c| if matches!(c.values, Values::Words(_)) { 'l' } else { 'r' }).collect();
        let mut out = String::from("\\begin{table}\n\\centering\n");
        if !self.caption.is_empty() {
            out += &format!("\\caption{{{}}}\n", escape::latex_markup(&self.caption));
        }
        if !self.label.is_empty() {
            out += &format!("\\label{{{}}}\n", escape::latex_label(&self.label));
        }
        out += &format!("\\begin{{tabular}}{{{align}}}\n\\toprule\n");
        let head: Vec<String> = self.columns.iter().map(|c| self.latex_head(c)).collect();
        out += &format!("{} \\\\\n\\midrule\n", head.join(" & "));
        for row in 0..rows(&self.columns) {
            let cells: Vec<String> = self.columns.iter().map(|c| self.latex_cell(c, row)).collect();
            out += &format!("{} \\\\\n", cells.join(" & "));
        }
        out += "\\bottomrule\n\\end{tabular}\n";
        for note in &self.notes {
            out += &format!("\\par\\smallskip\\footnotesize {}\n", escape::latex_markup(note));
        }
        out + "\\end{table}\n"
    }

    /// A pipe table.
    pub fn markdown(&self) -> String {
        let mut out = String::new();
        if !self.caption.is_empty() {
            out += &format!("**{}**\n\n", escape::markdown_markup(&self.caption));
        }
        let head: Vec<String> = self.columns.iter().map(|c| self.markdown_head(c)).collect();
        let rule = self.columns.iter().map(|c| if matches!(c.values, Values::Words(_)) { ":--" } else { "--:" });
        out += &format!("| {} |\n| {} |\n", head.join(" | "), rule.collect::<Vec<_>>().join(" | "));
        for row in 0..rows(&self.columns) {
            let cells = self.columns.iter().map(|c| self.markdown_cell(c, row));
            out += &format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "));
        }
        for note in &self.notes {
            out += &format!("\n{}\n", escape::markdown_markup(note));
        }
        out
    }

    fn latex_head(&self, c: &Column) -> String {
        let name = match self.symbols.head(c) {
            Some((symbol, word)) => format!("${symbol}${}", escape::latex(word)),
            None => escape::latex(&c.key),
        };
        if c.unit.is_empty() { name } else { format!("{name} / {}", latex_unit(&c.unit)) }
    }

    fn markdown_head(&self, c: &Column) -> String {
        let name = match self.symbols.head(c) {
            Some((symbol, word)) => format!("${}${}", without_bar(symbol), escape::markdown(word)),
            None => escape::markdown(&c.key),
        };
        if c.unit.is_empty() { name } else { format!("{name} / {}", escape::markdown(&c.unit)) }
    }

    fn latex_cell(&self, c: &Column, row: usize) -> String {
        let Some(text) = shown(c, row) else { return "--".into() };
        if matches!(c.values, Values::Words(_)) {
            return self.symbols.cell(c, &text).unwrap_or_else(|| escape::latex(&text));
        }
        match text.split_once('e') {
            Some((mantissa, power)) => format!("${mantissa}\\times 10^{{{power}}}$"),
            None if text.starts_with('-') => format!("${text}$"),
            None => text,
        }
    }

    fn markdown_cell(&self, c: &Column, row: usize) -> String {
        let Some(text) = shown(c, row) else { return "–".into() };
        self.symbols.cell(c, &text).map(|symbol| without_bar(&symbol)).unwrap_or_else(|| escape::markdown(&text))
    }

    /// [`csv`] of the columns.
    pub fn csv(&self) -> String {
        csv(&self.columns)
    }
}

/// Mathematics for a cell of Markdown, which a bar would end.
fn without_bar(symbol: &str) -> String {
    symbol.replace('|', "\\vert ")
}

fn latex_unit(unit: &str) -> String {
    let part = |(text, power): (&str, &str)| {
        let text = escape::latex(text).replace("{*}", "$\\cdot$");
        if power.is_empty() { text } else { format!("{text}$^{{{}}}$", escape::latex(power)) }
    };
    unit_parts(unit).into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let columns = vec![
            Column::words("source", vec!["Ec".into(), "a, b & c".into(), "error".into()]),
            Column::reals("F", vec![3003.42, 0.1712, f64::NAN]).with_digits(Digits::Significant(4)),
            Column::reals("p", vec![8.935_220_99e-41, 0.5, -0.000_01])
                .with_symbol("p")
                .with_digits(Digits::Significant(3)),
            Column::reals("rho", vec![2650.0, 2000.5, -1.0]).with_symbol(r"\rho").with_unit("kg/m^3"),
            Column::whole("df", vec![2, 2, 36]),
        ];
        Table {
            caption: "Analysis of 5 % & more".into(),
            label: "tab:a".into(),
            columns,
            notes: vec!["One note.".into()],
            symbols: Symbols::default(),
        }
    }

    #[test]
    fn names_and_terms_are_printed_by_their_symbols() {
        let of = [("kn_ks", "k_n/k_s"), ("mu", r"\mu"), ("R", "R|_0")].map(|(name, sign)| (name.into(), sign.into()));
        let term = ["mu", "kn_ks^2", "mu*kn_ks", "const", "mu*other", "mu^x", "R"];
        let columns = vec![
            Column::words("term", term.map(String::from).to_vec()),
            Column::words("remark", vec!["mu".into(); term.len()]),
        ];
        let symbols = Symbols { of: BTreeMap::from(of), columns: &["term"] };
        let table = Table { columns, symbols, ..Table::default() };
        let cells = |text: String, end: &str| -> Vec<String> {
            text.lines().filter(|line| line.contains("mu") && line.ends_with(end)).map(str::to_owned).collect()
        };
        assert_eq!(
            cells(table.latex(), r"\\"),
            [
                r"$\mu$ & mu \\",
                r"$(k_n/k_s)^{2}$ & mu \\",
                r"$\mu \cdot k_n/k_s$ & mu \\",
                r"const & mu \\",
                r"mu{*}other & mu \\",
                r"mu\textasciicircum{}x & mu \\",
                r"$R|_0$ & mu \\",
            ]
        );
        assert_eq!(cells(table.markdown(), "|")[6], r"| $R\vert _0$ | mu |");
        assert!(table.csv().contains("kn_ks^2,mu\n"), "programs read names");
        let published = Table { columns: vec![Column::reals("mu published", vec![1.0]).with_unit("%")], ..table };
        assert!(published.latex().contains("\n$\\mu$ published / \\% \\\\\n"), "{}", published.latex());
        assert!(published.markdown().contains("| $\\mu$ published / % |"), "{}", published.markdown());
    }

    #[test]
    fn whole_numbers_among_unlike_quantities_have_no_decimals() {
        let column =
            Column::reals("value", vec![24.0, 0.0, 44086.0, 0.974_31, 2.837e10]).with_digits(Digits::Unlike(3));
        let cells: Vec<String> = (0..5).filter_map(|row| shown(&column, row)).collect();
        assert_eq!(cells, ["24", "0", "44086", "0.974", "2.84e10"]);
    }

    #[test]
    fn csv_is_quoted_and_complete() {
        let got = table().csv();
        assert!(got.starts_with("source,F,p,rho [kg/m^3],df\nEc,3003.42,8.93522099e-41,2650,2\n"), "{got}");
        assert!(
            got.contains("\"a, b & c\",0.1712,0.5,2000.5,2\n") && got.ends_with("error,,-0.00001,-1,36\n"),
            "{got}"
        );
    }

    #[test]
    fn latex_has_rules_and_escapes() {
        let got = table().latex();
        assert!(
            got.contains("\\caption{Analysis of 5 \\% \\& more}\n\\label{tab:a}\n\\begin{tabular}{lrrrr}\n\\toprule\n")
        );
        assert!(got.contains("source & F & $p$ & $\\rho$ / kg/m$^{3}$ & df \\\\\n\\midrule\n"), "{got}");
        assert!(got.contains("Ec & 3003 & $8.94\\times 10^{-41}$ & 2650 & 2 \\\\\n"), "{got}");
        assert!(got.contains("a, b \\& c & 0.1712 & 0.500 & 2000.5 & 2 \\\\\n"), "{got}");
        assert!(got.contains("error & -- & $-1.00\\times 10^{-5}$ & $-1$ & 36 \\\\\n\\bottomrule"), "{got}");
    }

    #[test]
    fn markdown_aligns_numbers_right() {
        let got = table().markdown();
        assert!(got.starts_with("**Analysis of 5 % & more**\n\n| source | F | $p$ | $\\rho$ / kg/m^3 | df |\n| :-- | --: | --: | --: | --: |\n"), "{got}");
        assert!(got.contains("| error | – | -1.00e-5 | -1 | 36 |\n\nOne note.\n"), "{got}");
    }
}
