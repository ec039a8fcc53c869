//! Footnotes: sentences below a picture that its reader must know, such as runs that were left out.

use super::Style;
use super::palette::SOFT;
use super::scene::{Anchor, Scene};
use super::text::Line;

/// Size of the text relative to that of labels.
const SHARE: f64 = 0.95;
/// Line spacing relative to the size of the text.
const LEADING: f64 = 1.25;
/// White on both sides in mm.
const MARGIN: f64 = 1.2;

impl Scene {
    /// Adds sentences, which are labels ([`super::text`]), below everything on as many lines as they need, and their plain
    /// words to the description. The page grows.
    pub fn footnotes(&mut self, sentences: &[String], style: &Style) {
        let size = SHARE * style.size();
        for sentence in sentences {
            for line in wrapped(sentence, self.width - 2.0 * MARGIN, size) {
                self.height += LEADING * size;
                let at = [MARGIN, self.height - 0.3 * size];
                self.text(line, at, Anchor::Start, 0.0, SOFT);
            }
            let gap = if self.description.is_empty() { "" } else { " " };
            self.description += &format!("{gap}{}", Line::new(sentence, size).plain);
        }
        if !sentences.is_empty() {
            self.height += 0.4 * size;
        }
    }
}

/// Lines of words that fit the width; a word that is wider than a line has one of its own.
fn wrapped(sentence: &str, width: f64, size: f64) -> Vec<Line> {
    let set = |text: &str| Line::new(text, size);
    let (mut lines, mut current) = (Vec::new(), String::new());
    for word in words(sentence) {
        let longer = if current.is_empty() { word.clone() } else { format!("{current} {word}") };
        if set(&longer).width <= width || current.is_empty() {
            current = longer;
        } else {
            lines.push(set(&current));
            current = word;
        }
    }
    if !current.is_empty() {
        lines.push(set(&current));
    }
    lines
}

/// The words of a label; mathematics is not taken apart.
fn words(label: &str) -> Vec<String> {
    let mut found = vec![String::new()];
    let (mut inside, mut escaped) = (false, false);
    for letter in label.chars() {
        inside ^= letter == '$' && !escaped;
        escaped = letter == '\\' && !escaped;
        match found.last_mut() {
            Some(word) if inside || !letter.is_whitespace() => word.push(letter),
            _ => found.push(String::new()),
        }
    }
    found.retain(|word| !word.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::super::text::plain_text;
    use super::*;

    #[test]
    fn sentences_stand_below_the_picture_within_its_width() {
        let style = Style::wide(60.0);
        let mut scene = Scene::new(60.0, 40.0);
        let sentence =
            "3 of 24 runs are not valid and were left out: rotation (2); cracks near the loaded diameter (1).";
        scene.footnotes(&[sentence.to_owned(), plain_text("One more costs $5.")], &style);
        let texts = scene.texts();
        assert!(texts.len() >= 3, "{texts:?}");
        assert_eq!(
            texts.iter().map(|(text, _)| text.as_str()).collect::<Vec<_>>().join(" "),
            format!("{sentence} One more costs $5.")
        );
        for (text, corners) in &texts {
            let inside = |[x, y]: &[f64; 2]| (0.0..=60.0).contains(x) && (40.0..=scene.height).contains(y);
            assert!(corners.iter().all(inside), "{text}: {corners:?} of {}", scene.height);
        }
        assert_eq!(scene.faults(), Vec::<String>::new());
        assert!(scene.description.ends_with("costs $5."));
    }

    #[test]
    fn a_symbol_is_one_word_of_a_sentence() {
        assert_eq!(words(r"a $\sigma _{t}$: 1 \$ b"), ["a", r"$\sigma _{t}$:", "1", r"\$", "b"]);
        assert_eq!(words(&plain_text("3 $ of 4")), ["3", r"$\$$", "of", "4"]);
        let mut scene = Scene::new(60.0, 40.0);
        scene.footnotes(&[r"$\sigma_t$: 1 of 4 runs is not valid.".to_owned()], &Style::wide(60.0));
        assert_eq!(scene.description, "σ_t: 1 of 4 runs is not valid.");
    }

    #[test]
    fn nothing_to_say_changes_nothing() {
        let mut scene = Scene::new(60.0, 40.0);
        scene.footnotes(&[], &Style::wide(60.0));
        assert_eq!(scene, Scene::new(60.0, 40.0));
    }
}
