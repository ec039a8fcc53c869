//! Footnotes: sentences below a picture that its reader must know, such as runs that were left out.

use super::Style;
use super::palette::SOFT;
use super::scene::{Anchor, Scene};
use super::text::{Line, plain_text};

/// Size of the text relative to that of labels.
const SHARE: f64 = 0.95;
/// Line spacing relative to the size of the text.
const LEADING: f64 = 1.25;
/// White on both sides in mm.
const MARGIN: f64 = 1.2;

impl Scene {
    /// Adds sentences below everything, on as many lines as they need, and to the description. The page grows.
    pub fn footnotes(&mut self, sentences: &[String], style: &Style) {
        let size = SHARE * style.size();
        for sentence in sentences {
            for line in wrapped(sentence, self.width - 2.0 * MARGIN, size) {
                self.height += LEADING * size;
                let at = [MARGIN, self.height - 0.3 * size];
                self.text(line, at, Anchor::Start, 0.0, SOFT);
            }
            let gap = if self.description.is_empty() { "" } else { " " };
            self.description += &format!("{gap}{sentence}");
        }
        if !sentences.is_empty() {
            self.height += 0.4 * size;
        }
    }
}

/// Lines of words that fit the width; a word that is wider than a line has one of its own.
fn wrapped(sentence: &str, width: f64, size: f64) -> Vec<Line> {
    let set = |text: &str| Line::new(&plain_text(text), size);
    let (mut lines, mut current) = (Vec::new(), String::new());
    for word in sentence.split_whitespace() {
        let longer = if current.is_empty() { word.to_owned() } else { format!("{current} {word}") };
        if set(&longer).width <= width || current.is_empty() {
            current = longer;
        } else {
            lines.push(set(&current));
            word.clone_into(&mut current);
        }
    }
    if !current.is_empty() {
        lines.push(set(&current));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_stand_below_the_picture_within_its_width() {
        let style = Style::wide(60.0);
        let mut scene = Scene::new(60.0, 40.0);
        let sentence =
            "3 of 24 runs are not valid and were left out: rotation (2); cracks near the loaded diameter (1).";
        scene.footnotes(&[sentence.to_owned(), "One more costs $5.".to_owned()], &style);
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
    fn nothing_to_say_changes_nothing() {
        let mut scene = Scene::new(60.0, 40.0);
        scene.footnotes(&[], &Style::wide(60.0));
        assert_eq!(scene, Scene::new(60.0, 40.0));
    }
}
