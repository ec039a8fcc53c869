//! The whole page, from campaigns made up here.

use super::page::STYLE;
use super::{Cost, Outcome, Paper, Part, State, page};
use crate::artifact::presentation::Picture;
use crate::artifact::{Artifact, ArtifactKind, Group, Node, Table};
use crate::stage::Context;
use figure::dag::{Dag, Stage};
use figure::{Figure, Style, palette, scene::Color, svg::svg};
use serde_json::json;
use std::sync::Arc;

const HOSTILE: &str = "</script></style><script>alert(1)</script><img src=x onerror=alert(1)>\"'&";

fn part(name: &str, kind: &str, inputs: &[usize], artifact: Option<Artifact>) -> Part {
    let state = artifact.map_or(State::Missing, |artifact| State::Done {
        content: artifact.content_hash(),
        artifact: Arc::new(artifact),
    });
    let inputs = inputs.iter().map(|&input| ("of".to_owned(), input)).collect();
    let settings = json!({ "caption": HOSTILE, "notes": [HOSTILE], "show": "points", "text": HOSTILE });
    Part {
        title: None,
        name: name.to_owned(),
        kind: kind.to_owned(),
        class: crate::stage::kind(kind).unwrap().class,
        about: HOSTILE.to_owned(),
        inputs,
        settings,
        state,
        cost: Cost::default(),
        outcome: Outcome::default(),
    }
}

fn hostile() -> Paper {
    let table = || {
        Table { about: HOSTILE.to_owned(), ..Table::default() }
            .texts_column(HOSTILE, HOSTILE, vec![HOSTILE.to_owned()])
            .reals_column("value", HOSTILE, HOSTILE, vec![1.0 / 3.0])
    };
    let results = Artifact::of(ArtifactKind::RESULTS, Group::new().with("runs", Node::Table(table())));
    let printed = Artifact::of(ArtifactKind::TABLE, Group::new().with("table", Node::Table(table())));
    let svg = format!("<svg viewBox=\"0 0 9 9\"><title>{HOSTILE}</title></svg>");
    let picture = Picture {
        title: HOSTILE.to_owned(),
        description: HOSTILE.to_owned(),
        svg,
        pdf: Vec::new(),
        png: Vec::new(),
        moving: Some(HOSTILE.to_owned()),
        data: Table::default(),
    };
    Paper {
        title: HOSTILE.to_owned(),
        about: HOSTILE.to_owned(),
        file: HOSTILE.to_owned(),
        text: HOSTILE.to_owned(),
        profile: Some(HOSTILE.to_owned()),
        sets: vec![HOSTILE.to_owned()],
        store: HOSTILE.to_owned(),
        context: Context::default(),
        parts: vec![
            part("first", "simulate", &[], Some(results)),
            part("printed", "table", &[0], Some(printed)),
            part("picture", "figure", &[0], Some(picture.to_artifact())),
            part("later", "anova", &[0], None),
        ],
        runs: Vec::new(),
    }
}

/// Tags of a page in order, without what scripts and styles hold. Panics when tags are not balanced.
fn tags(page: &str) -> Vec<String> {
    const VOID: [&str; 3] = ["meta", "img", "link"];
    let (mut found, mut open, mut rest) = (Vec::new(), Vec::new(), page);
    while let Some(at) = rest.find('<') {
        let end = at + rest[at..].find('>').unwrap();
        let tag = rest[at + 1..end].to_owned();
        rest = &rest[end + 1..];
        let name = tag.trim_end_matches('/').split(' ').next().unwrap().to_owned();
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "before …{}", &rest[..rest.len().min(80)]);
        } else if name == "script" || name == "style" {
            rest = rest.split_once(&format!("</{name}>")).unwrap().1;
        } else if name != "!DOCTYPE" && !VOID.contains(&name.as_str()) && !tag.ends_with('/') {
            open.push(name);
        }
        found.push(tag);
    }
    assert_eq!(open, Vec::<String>::new());
    found
}

#[test]
fn what_a_workflow_or_a_store_says_stays_text() {
    let page = page(&hostile());
    let tags = tags(&page);
    let count = |name: &str| tags.iter().filter(|tag| tag.split(' ').next() == Some(name)).count();
    // One script runs; the other element is data.
    let data =
        tags.iter().filter(|tag| tag.starts_with("script ") && tag.ends_with("type=\"application/json\"")).count();
    assert_eq!((count("script"), data, count("style"), count("img")), (2, 1, 1, 0));
    assert!(!page.contains("<img src=x") && !page.contains("<script>alert"));
    assert!(page.contains("&lt;/script&gt;"));
}

#[test]
fn a_page_names_no_other_address() {
    let page = page(&hostile());
    for attribute in ["src=\"", "href=\"", "url("] {
        for (at, _) in page.match_indices(attribute) {
            let target = &page[at + attribute.len()..];
            assert!(target.starts_with('#') || target.starts_with("data:"), "{attribute}{}", &target[..40]);
        }
    }
    let policy = page.split_once("Content-Security-Policy").unwrap().1.split_once('>').unwrap().0;
    assert!(
        policy.contains("default-src 'none'") && !policy.contains("unsafe") && !policy.contains("http"),
        "{policy}"
    );
}

#[test]
fn what_is_missing_is_named_with_its_command() {
    let mut paper = hostile();
    paper.file = "w.toml".to_owned();
    (paper.profile, paper.sets, paper.store) = (None, vec!["stage.a.b=1 mm".to_owned()], String::new());
    assert_eq!(paper.missing(), ["later"]);
    let page = page(&paper);
    assert!(page.contains("<b>Incomplete. </b>"));
    assert!(page.contains("flow run w.toml --set 'stage.a.b=1 mm' later"));
}

#[test]
fn the_same_campaign_gives_the_same_page() {
    assert!(page(&hostile()) == page(&hostile()));
}

#[test]
fn tables_and_figures_stand_with_what_they_show() {
    let paper = hostile();
    assert_eq!((0..4).map(|i| paper.home(i)).collect::<Vec<_>>(), [0, 0, 0, 3]);
}

#[test]
fn the_look_knows_the_inks_of_the_pictures() {
    let hex = |Color(r, g, b): Color| match [r, g, b].iter().all(|c| c % 17 == 0) {
        true => format!("#{:x}{:x}{:x}", r / 17, g / 17, b / 17),
        false => format!("#{r:02x}{g:02x}{b:02x}"),
    };
    for color in
        [palette::INK, palette::SOFT, palette::GRID, palette::WASH, palette::BAND, palette::PAPER, palette::mode(1)]
    {
        assert!(STYLE.contains(&format!("=\"{}\"]", hex(color))), "{color:?}");
    }
    let stages = (0..3).map(|class| Stage { name: "a".to_owned(), note: String::new(), class });
    let classes = vec![String::from("x"); 3];
    let drawn = svg(&Dag { stages: stages.collect(), edges: Vec::new(), classes }.scene(&Style::wide(90.0)));
    for (at, _) in drawn.match_indices("fill=\"#") {
        let fill = drawn[at..].split('"').nth(1).unwrap();
        assert!(STYLE.contains(&format!("[fill=\"{fill}\"]")), "{fill} of the boxes of the workflow");
    }
}
