//! A table of the page: heads with symbols and units, numbers as people read them, deviations with a sign and a word.
//!
//! A cell whose number is rounded carries the number with nine digits in `data-v`, from which the script sorts and
//! copies; heads carry the plain name and unit in `data-k`.

use super::symbol;
use crate::artifact::{self, Values};
use crate::stage::{Context, NAMING_COLUMNS};
use figure::column::{self, Column, Digits};
use figure::table::shown;
use maud::{Markup, PreEscaped, html};
use serde_json::Value;
use std::collections::BTreeMap;

/// A table to be shown.
pub(super) struct Sheet<'a> {
    table: &'a artifact::Table,
    context: &'a Context,
    caption: Markup,
    notes: Vec<String>,
    /// The command that shows all of it.
    command: String,
    /// Most rows in the page.
    most: usize,
    digits: usize,
    decimals: BTreeMap<String, usize>,
    symbols: BTreeMap<String, String>,
    judgements: Option<Judgements>,
    /// Whether it is a table of the stage itself, which shows only columns that say something; a printed one shows all.
    is_own: bool,
}

/// What stands in place of the deviations of a column, where per cent say nothing.
pub(super) struct Judgements {
    /// The column.
    pub(super) column: String,
    /// Its head, and the unit of its numbers in words.
    pub(super) head: &'static str,
    pub(super) unit: &'static str,
    /// Its rows; none of rows that are not judged.
    pub(super) cells: Vec<Option<Cell>>,
}

/// A judged deviation.
pub(super) struct Cell {
    pub(super) number: Option<String>,
    pub(super) judged: Judged,
}

/// Most rows of a table that a stage prints, and of any other.
const PRINTED: usize = 500;
const OTHERS: usize = 100;

/// Tables with more columns than this are wide, and texts with more letters in them are long.
const WIDE: usize = 6;
const LONG: usize = 60;

/// Within so many per cent two values are close, and beyond the second they are far apart.
pub(super) const CLOSE: f64 = 5.0;
pub(super) const FAR: f64 = 20.0;

impl<'a> Sheet<'a> {
    /// A table as it lies in an artifact.
    pub(super) fn new(table: &'a artifact::Table, context: &'a Context, caption: Markup, command: String) -> Self {
        Self {
            table,
            context,
            caption,
            notes: Vec::new(),
            command,
            most: OTHERS,
            digits: 5,
            decimals: BTreeMap::new(),
            symbols: BTreeMap::new(),
            judgements: None,
            is_own: true,
        }
    }

    /// The same with judged deviations.
    pub(super) fn judged(mut self, judgements: Option<Judgements>) -> Self {
        self.judgements = judgements;
        self
    }

    /// The judged deviations of a column.
    fn judgements_of(&self, column: &str) -> Option<&Judgements> {
        self.judgements.as_ref().filter(|own| own.column == column)
    }

    /// The same as a `table` stage with these settings prints it.
    pub(super) fn printed(mut self, settings: &Value) -> Self {
        let list = |key: &str| settings[key].as_array().into_iter().flatten();
        let map = |key: &str| settings[key].as_object().into_iter().flatten();
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        self.most = PRINTED;
        self.is_own = false;
        self.digits = settings["digits"].as_u64().map_or(4, |digits| digits as usize);
        self.decimals = map("decimals").filter_map(|(k, v)| Some((k.clone(), v.as_u64()? as usize))).collect();
        self.symbols = map("symbols").map(|(k, v)| (k.clone(), text(v))).collect();
        self.notes = list("notes").map(text).collect();
        self
    }

    pub(super) fn markup(&self) -> Markup {
        let (empty, filled): (Vec<&artifact::Column>, Vec<_>) =
            self.table.columns.iter().partition(|column| self.leaves_out(column));
        let columns: Vec<Shown> = filled.into_iter().map(|column| self.column(column)).collect();
        let rows = self.table.rows();
        let named = columns.first().is_some_and(|first| first.is_text());
        html! {
            div.sheet {
                table {
                    caption { span { (self.caption) } }
                    thead { tr { @for column in &columns { (self.head(column)) } } }
                    tbody {
                        @for row in 0..rows.min(self.most) {
                            tr {
                                @for (index, column) in columns.iter().enumerate() {
                                    (self.cell(column, row, named && index == 0))
                                }
                            }
                        }
                    }
                }
            }
            @for note in &self.notes { p.note { (note) } }
            @if !empty.is_empty() {
                p.note { "Empty in every row: " (empty.iter().map(|c| c.name.replace('_', " ")).collect::<Vec<_>>().join(", ")) "." }
            }
            @if rows > self.most {
                p.note { "The first " (self.most) " of " (rows) " rows; all of them: " code { (self.command) " --csv" } }
            }
        }
    }

    /// Whether a column of words that a stage declares says nothing here, such as why runs failed where none did.
    fn leaves_out(&self, column: &artifact::Column) -> bool {
        let is_blank = matches!(&column.values, Values::Texts(texts) if texts.iter().all(String::is_empty));
        self.is_own && !column.about.is_empty() && is_blank && self.table.rows() > 0
    }

    fn column(&self, column: &'a artifact::Column) -> Shown<'a> {
        let values = match &column.values {
            Values::Reals(values) => column::Values::Reals(values.clone()),
            Values::Ints(values) => column::Values::Whole(values.clone()),
            Values::Texts(values) => column::Values::Words(values.clone()),
        };
        let mark = Mark::of(column);
        let digits = match self.decimals.get(&column.name) {
            Some(&decimals) => Digits::Fixed(decimals),
            None if mark.is_some() => Digits::Fixed(1),
            None if column.values.are_short() => Digits::Shortest,
            None if column.name == "value" && self.table.column("unit").is_some() => Digits::Unlike(self.digits),
            None => Digits::Significant(self.digits),
        };
        let own = Column { key: column.name.clone(), symbol: String::new(), unit: column.unit.clone(), values, digits };
        Shown { column: own, about: &column.about, mark }
    }

    fn head(&self, shown: &Shown) -> Markup {
        let key = shown.column.key.as_str();
        if let Some(Judgements { head, unit, .. }) = self.judgements_of(key) {
            return html! { th scope="col" data-k=(head) { (head) @if !unit.is_empty() { " " small { (unit) } } } };
        }
        let (quantity, word) = key.split_once(' ').unwrap_or((key, ""));
        let symbol = match self.symbols.get(quantity) {
            Some(symbol) => Some(symbol::label(&format!("${symbol}$"))),
            None => symbol::of(self.context, quantity),
        };
        let unit = shown.column.unit.as_str();
        let plain = if unit.is_empty() { key.to_owned() } else { format!("{key} [{unit}]") };
        html! {
            th scope="col" class=[shown.is_text().then_some("t")] data-k=(plain) title=[(!shown.about.is_empty()).then_some(shown.about)] {
                @if let Some(symbol) = symbol { (symbol) @if !word.is_empty() { " " (word) } } @else if let Some(word) = self.word_of_field(shown) { (symbol::label(word)) } @else { (key.replace('_', " ")) }
                @if !unit.is_empty() { " " small { (symbol::unit(unit)) } }
            }
        }
    }

    /// The field's word for a column that a stage declares.
    fn word_of_field(&self, shown: &Shown) -> Option<&'static str> {
        let word = FIELD.iter().find(|(key, _)| *key == shown.column.key);
        word.filter(|_| !shown.about.is_empty()).map(|(_, word)| *word)
    }

    fn cell(&self, shown: &Shown, row: usize, is_name: bool) -> Markup {
        if let Some(judgements) = self.judgements_of(&shown.column.key) {
            return judged_cell(judgements.cells.get(row).and_then(Option::as_ref));
        }
        let inside = shown.cell(row);
        match &shown.column.values {
            column::Values::Words(words) => {
                let word = words.get(row).map_or("", String::as_str);
                let markup = self.words(shown, word);
                let full = markup.is_some().then_some(word);
                let markup = markup.unwrap_or_else(|| coded(word));
                // In a wide table a sentence would make its row many lines tall.
                let is_long = self.table.columns.len() > WIDE && word.chars().count() > LONG;
                let markup = if is_long {
                    html! { span.long tabindex="0" title=(word) { (markup) } }
                } else {
                    markup
                };
                let class = match word.starts_with("differs") {
                    true => "t far",
                    false if self.table.columns.len() > WIDE && !is_long => "t one",
                    false => "t",
                };
                if is_name {
                    html! { th.t scope="row" data-v=[full] { (markup) } }
                } else {
                    html! { td class=(class) data-v=[full] { (markup) } }
                }
            }
            column::Values::Reals(values) => {
                let value = values.get(row).copied().unwrap_or(f64::NAN);
                let Some(inside) = inside else { return html! { td {} } };
                match shown.mark.map(|mark| (mark, mark.judge(value))) {
                    Some((mark, judged)) => html! {
                        td class=(judged.class) data-v=(nine(value)) {
                            @if mark == Mark::Signed && value > 0.0 { "+" } (number(&inside)) " " em { (judged.sign) " " (judged.word) }
                        }
                    },
                    None => {
                        let full = Some(nine(value)).filter(|full| *full != inside);
                        html! { td data-v=[full] { (number(&inside)) } }
                    }
                }
            }
            column::Values::Whole(_) => html! { td { (number(&inside.unwrap_or_default())) } },
        }
    }

    /// A word that names a factor, a response or a term of them, with its symbol.
    fn words(&self, shown: &Shown, word: &str) -> Option<Markup> {
        NAMING_COLUMNS.contains(&shown.column.key.as_str()).then(|| symbol::term(self.context, word)).flatten()
    }
}

/// Columns of statistics as the field calls them, in the notation of labels.
const FIELD: [(&str, &str); 22] = [
    ("std_error", "std. error"),
    ("df", "d.f."),
    ("df_residual", "residual d.f."),
    ("df_pure_error", "pure-error d.f."),
    ("ss", "$SS$"),
    ("ms", "$MS$"),
    ("f", "$F$"),
    ("t", "$t$"),
    ("p", "$p$"),
    ("n", "$n$"),
    ("s", "$s$"),
    ("r2", "$R^2$"),
    ("r2_adjusted", "$R^2$ adjusted"),
    ("r2_predicted", "$R^2$ predicted"),
    ("eta2", r"$\eta^2$"),
    ("omega2", r"$\omega^2$"),
    ("press", "PRESS"),
    ("lack_of_fit_f", "$F$ of lack of fit"),
    ("lack_of_fit_p", "$p$ of lack of fit"),
    ("cook", "Cook’s $D$"),
    ("low", "lower limit"),
    ("high", "upper limit"),
];

/// A sentence with its keys and values as code.
fn coded(text: &str) -> Markup {
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return html! { (text) };
    }
    html! { @for (i, part) in parts.iter().enumerate() { @if i % 2 == 1 { code { (part) } } @else { (part) } } }
}

/// A column with how it is shown.
struct Shown<'a> {
    column: Column,
    about: &'a str,
    mark: Option<Mark>,
}

impl Shown<'_> {
    fn is_text(&self) -> bool {
        matches!(self.column.values, column::Values::Words(_))
    }

    fn cell(&self, row: usize) -> Option<String> {
        shown(&self.column, row)
    }
}

/// A column that says how far two values are apart, in per cent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mark {
    /// Computed minus the other.
    Signed,
    /// The size of it.
    Size,
}

/// What a deviation comes to.
pub(super) struct Judged {
    pub(super) class: &'static str,
    pub(super) sign: &'static str,
    pub(super) word: &'static str,
}

impl Mark {
    /// What a column says, by its name.
    pub(super) fn of(column: &artifact::Column) -> Option<Self> {
        match column.name.as_str() {
            "deviation_percent" => Some(Self::Signed),
            "relative_error_percent" => Some(Self::Size),
            name if name.ends_with(" deviation") && column.unit == "%" => Some(Self::Signed),
            _ => None,
        }
    }

    pub(super) fn judge(self, value: f64) -> Judged {
        let judged = |class, sign, word| Judged { class, sign, word };
        let (far, up) = (value.abs() > FAR, value > 0.0);
        match self {
            _ if value.is_nan() => judged("", "", ""),
            _ if value.abs() <= CLOSE => judged("close", "≈", "close"),
            Self::Signed if far && up => judged("far", "↑", "far high"),
            Self::Signed if far => judged("far", "↓", "far low"),
            Self::Signed if up => judged("off", "↑", "high"),
            Self::Signed => judged("off", "↓", "low"),
            Self::Size if far => judged("far", "≠", "far off"),
            Self::Size => judged("off", "≠", "off"),
        }
    }
}

fn judged_cell(cell: Option<&Cell>) -> Markup {
    let Some(Cell { number: own, judged }) = cell else { return html! { td {} } };
    let value = own.as_deref().unwrap_or(judged.word);
    html! {
        td class=(judged.class) data-v=(value) {
            @if let Some(own) = own { @if !own.starts_with('-') { "+" } (number(own)) " " }
            em { (judged.sign) " " (judged.word) }
        }
    }
}

/// A number as it is set: true minus signs, powers of ten.
pub(super) fn number(text: &str) -> Markup {
    let minus = |text: &str| text.replace('-', "−");
    match text.split_once('e') {
        Some((mantissa, power)) if power.trim_start_matches('-').bytes().all(|b| b.is_ascii_digit()) => {
            html! { (minus(mantissa)) (PreEscaped("·10")) sup { (minus(power)) } }
        }
        _ => html! { (minus(text)) },
    }
}

/// A number with nine digits at most, as programs read it.
pub(super) fn nine(value: f64) -> String {
    let rounded: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-5..1e15).contains(&rounded.abs()) { format!("{rounded:e}") } else { format!("{rounded}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_set_and_kept() {
        assert_eq!(number("-1.5").into_string(), "−1.5");
        assert_eq!(number("8.94e-41").into_string(), "8.94·10<sup>−41</sup>");
        assert_eq!(number("residual").into_string(), "residual");
        assert_eq!(
            [nine(0.1 + 0.2), nine(1.0 / 3.0), nine(2.5e-9), nine(-0.0)],
            ["0.3", "0.333333333", "2.5e-9", "-0"]
        );
    }

    #[test]
    fn deviations_have_a_sign_and_a_word() {
        let words = |mark: Mark, value: f64| {
            let judged = mark.judge(value);
            format!("{} {}", judged.sign, judged.word)
        };
        assert_eq!(words(Mark::Signed, -4.9), "≈ close");
        assert_eq!([words(Mark::Signed, 5.1), words(Mark::Signed, -21.0)], ["↑ high", "↓ far low"]);
        assert_eq!([words(Mark::Size, 12.0), words(Mark::Size, 20.1)], ["≠ off", "≠ far off"]);
        assert_eq!(words(Mark::Signed, f64::NAN), " ");
    }

    #[test]
    fn a_declared_column_that_says_nothing_is_named_below_the_table() {
        let table = artifact::Table::default()
            .reals_column("UCS", "MPa", "", vec![30.0, 31.0])
            .texts_column("failure", "why a run has no result", vec![String::new(); 2])
            .texts_column("remark", "", vec![String::new(); 2]);
        let context = Context::default();
        let sheet = || Sheet::new(&table, &context, html! { "c" }, String::new());
        let text = sheet().markup().into_string();
        assert!(!text.contains(">failure<") && text.contains("Empty in every row: failure."), "{text}");
        assert!(text.contains(">remark<"), "{text}");
        assert!(sheet().printed(&Value::Null).markup().into_string().contains(">failure<"));
    }

    #[test]
    fn cells_are_text_whatever_they_hold() {
        let table = artifact::Table::default()
            .texts_column("term", "", vec!["</td><script>alert(1)</script>".to_owned()])
            .reals_column("UCS deviation", "%", "\"><img>", vec![12.345])
            .reals_column("p", "<b>", "", vec![1e-7]);
        let context = Context::default();
        let text = Sheet::new(&table, &context, html! { "c" }, String::new()).markup().into_string();
        assert!(!text.contains("<script") && !text.contains("<img") && !text.contains("<b>"), "{text}");
        assert!(text.contains("+12.3 <em>↑ high</em>") && text.contains("data-v=\"12.345\""), "{text}");
    }
}
