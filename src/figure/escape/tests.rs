//! Hostile texts through every function, each judged by a small reader of the destination.

use super::*;
use proptest::prelude::*;

const HOSTILE: [&str; 12] = [
    r"5 $ & \input{/etc/hostname} 100% #1",
    "a $x$ b & c",
    "two $ signs & $",
    r"\\[2cm] * [5]",
    "| a | b",
    "</text><script>alert(1)</script>",
    "a\"b'c",
    "line\n\nline\u{0}\u{1b}[31m",
    "=1+2",
    "**bold** <b> `code` [x](y)",
    "--- ?`!`",
    "",
];

/// LaTeX as a reader takes it: what is printed, or nothing where a command other than the known ones would run.
fn printed(text: &str) -> Option<String> {
    let known = [
        ("textbackslash{}", "\\"),
        ("textasciicircum{}", "^"),
        ("textasciitilde{}", "~"),
        ("textless{}", "<"),
        ("textgreater{}", ">"),
        ("textbar{}", "|"),
        ("%", "%"),
        ("&", "&"),
        ("#", "#"),
        ("_", "_"),
        ("{", "{"),
        ("}", "}"),
        ("$", "$"),
    ];
    let (mut out, mut rest) = (String::new(), text);
    let mut depth = 0;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        match c {
            '\\' => {
                let (command, sign) = known.iter().find(|(command, _)| rest.starts_with(command))?;
                out += sign;
                rest = &rest[command.len()..];
            }
            '{' => depth += 1,
            '}' => depth -= 1,
            '%' | '&' | '#' | '_' | '$' | '^' | '~' => return None,
            c => out.push(c),
        }
    }
    (depth == 0).then_some(out)
}

/// CommonMark as a reader takes it: what is printed, or nothing where a sign would have a meaning.
fn rendered(text: &str) -> Option<String> {
    let (mut out, mut escaped) = (String::new(), false);
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '&' if !escaped && rest.peek().is_some_and(|next| next.is_alphanumeric() || *next == '#') => return None,
            '\\' if !escaped => {
                escaped = true;
                continue;
            }
            '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '$' | '~' | '#' if !escaped => return None,
            '\n' | '\r' => return None,
            c => out.push(c),
        }
        escaped = false;
    }
    Some(out)
}

fn in_one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_whitespace() || c.is_control() { ' ' } else { c }).collect()
}

fn unescaped(text: &str) -> String {
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
}

fn judge(text: &str) {
    assert_eq!(printed(&latex(text)).as_deref(), Some(&*in_one_line(text)), "{text:?}: {}", latex(text));
    assert_eq!(rendered(&markdown(text)).as_deref(), Some(&*in_one_line(text)), "{text:?}: {}", markdown(text));
    let xml = xml(text);
    assert!(!xml.contains(['<', '>', '"']) && !xml.contains(is_control), "{text:?}: {xml}");
    let clean: String = text.chars().map(|c| if is_control(c) { '\u{fffd}' } else { c }).collect();
    assert_eq!(unescaped(&xml), clean);
    let file = format!("head,other\n{},{}\n", csv(text), csv("x"));
    let mut read = ::csv::Reader::from_reader(file.as_bytes());
    let record = read.records().next().unwrap().unwrap();
    assert_eq!((&record[0], &record[1], record.len()), (text, "x", 2), "{file:?}");
    assert!(latex_label(text).chars().all(|c| c.is_ascii_alphanumeric() || ":._-".contains(c)));
}

#[test]
fn hostile_texts_stay_texts() {
    HOSTILE.iter().for_each(|text| judge(text));
}

#[test]
fn captions_hold_mathematics_that_is_known_and_nothing_else() {
    assert_eq!(latex_markup(r"Strength $\bar\sigma_c$ of 5 % & more"), r"Strength $\bar\sigma_c$ of 5 \% \& more");
    assert_eq!(latex_markup("$5 and $6"), r"\$5 and \$6");
    assert_eq!(latex_markup("a $ b"), r"a \$ b");
    assert_eq!(latex_markup(r"$\input{x}$"), r"\$\textbackslash{}input\{x\}\$");
    assert_eq!(latex_markup("$a % b$ $c$"), r"\$a \% b\$ $c$");
    assert_eq!(
        latex_markup(r"Costs in $ & 100 % \input{/etc/hostname}"),
        r"Costs in \$ \& 100 \% \textbackslash{}input\{/etc/hostname\}"
    );
    assert_eq!(markdown_markup("*a* $x_1$ | b"), r"\*a\* $x_1$ \| b");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_text_stays_text(text in any::<String>(), signs in r#"[\\\\$&%#_{}^~<>|*`\[\]"'=+@a -]{0,24}"#) {
        judge(&text);
        judge(&signs);
    }

    /// What passes as mathematics holds no command that a figure does not know, and no comment or end of a cell.
    #[test]
    fn no_command_passes_in_a_caption(text in r"[\\$&%a-c{}_^ 0-9]{0,24}") {
        for (mathematics, piece) in pieces(&text) {
            prop_assert!(!mathematics || is_mathematics(piece));
        }
        let whole: String = pieces(&text).iter().map(|(m, piece)| if *m { format!("${piece}$") } else { (*piece).to_owned() }).collect();
        prop_assert_eq!(whole, text);
    }
}
