//! The line that names the columns, below titles of a laboratory.

/// A line as its cells, empty where nothing stands.
type Line<'a> = Vec<&'a str>;

/// The columns of a line that hold something.
fn filled<'a>(line: &'a [&str]) -> impl Iterator<Item = usize> + Clone + 'a {
    line.iter().enumerate().filter(|(_, cell)| !cell.trim().is_empty()).map(|(column, _)| column)
}

/// Index of the line that names the columns. It is the first line unless values stand in columns that it does not name; then
/// the first line below that names all columns which hold something further down, in words only, and has numbers below it.
///
/// A line above it must be a title: one text, or several from the first column on. A line whose first cell alone is empty
/// names the columns but forgets one, and nothing is guessed from it. `None` where no line is a head.
pub(super) fn find(lines: &[Line], is_number: impl Fn(&str) -> bool) -> Option<usize> {
    let width = lines.iter().map(Vec::len).max()?;
    // the columns that hold something below each line, from the last line up
    let mut below = vec![vec![false; width]; lines.len()];
    let mut numbers = vec![false; lines.len()];
    for at in (1..lines.len()).rev() {
        let mut own = below[at].clone();
        filled(&lines[at]).for_each(|column| own[column] = true);
        below[at - 1] = own;
        numbers[at - 1] = numbers[at] || lines[at].iter().any(|cell| is_number(cell));
    }
    let names_all =
        |at: usize| (0..width).all(|column| !below[at][column] || lines[at].get(column).is_some_and(|c| !c.is_empty()));
    if names_all(0) {
        return Some(0);
    }
    let left = below[0].iter().position(|is_used| *is_used)?;
    let is_title =
        |line: &Line| filled(line).nth(1).is_none() || filled(line).next().is_some_and(|column| column <= left);
    let is_head = |at: &usize| {
        let (at, line) = (*at, &lines[*at]);
        filled(line).nth(1).is_some() && names_all(at) && numbers[at] && !line.iter().any(|cell| is_number(cell))
    };
    (1..lines.len()).take_while(|at| is_title(&lines[at - 1])).find(is_head)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(lines: &[&str]) -> Option<usize> {
        let lines: Vec<Line> = lines.iter().map(|line| line.split(';').collect()).collect();
        find(&lines, |cell| cell.replace(',', ".").parse::<f64>().is_ok())
    }

    #[test]
    fn the_head_stands_below_titles_or_in_the_first_line() {
        assert_eq!(found(&["a;b", "1;2"]), Some(0));
        assert_eq!(found(&["Labor", "Auftrag 12", "Probe;fc", "P1;31,2"]), Some(2));
        // as spreadsheets write it, with a title of two cells and units below the names
        assert_eq!(found(&["Labor;;", "Datum;12.03.2024;", "Probe;fc;Bem", ";MPa;", "P1;31,2;", "P2;30;x"]), Some(2));
        // a head that is complete is one, whatever follows
        assert_eq!(found(&["Probe;1", "x;y", "P1;2"]), Some(0));
        // a sheet whose table stands to the right, and a title beside it
        assert_eq!(found(&[";;Titel", ";w;fc", ";0,5;31"]), Some(1));
    }

    #[test]
    fn nothing_is_guessed_where_a_name_is_missing() {
        // the first name, the last name; heads in two lines; numbers as names; words only
        assert_eq!(found(&[";mix;grade", "P1;A;low", "P2;B;5"]), None);
        assert_eq!(found(&["a;b", "1;2;late"]), None);
        assert_eq!(found(&["Probe;Festigkeit;;", ";fc;ft;E", "P1;1;2;3"]), None);
        assert_eq!(found(&["Labor", "Probe;7;28", "P1;31;40"]), None);
        assert_eq!(found(&["Labor", "Probe;Sorte", "P1;A"]), None);
    }
}
