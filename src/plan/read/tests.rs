#![allow(dead_code)] // fields are read from text, and that is the test
use super::super::node::Sources;
use super::super::syntax;
use super::*;
use crate::unit::{Length, Pressure};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Every form that a stage's type may take.
#[derive(Debug, Deserialize)]
struct Everything {
    a: f64,
    b: Length,
    c: Vec<u32>,
    d: Option<Inner>,
    e: Word,
    f: BTreeMap<String, f64>,
    #[serde(default)]
    g: [f64; 2],
}

#[derive(Debug, Deserialize)]
struct Inner {
    x: bool,
    y: Pressure,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Word {
    LeastSquares,
    Ridge { lambda: f64 },
}

/// The forms that serde copies first.
#[derive(Debug, Deserialize)]
struct Copied {
    name: String,
    #[serde(flatten)]
    method: Method,
    law: Option<Law>,
    either: Option<Either>,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "method", rename_all = "kebab-case")]
enum Method {
    Genetic { population: u32, rate: Option<f64> },
    Annealing { start: f64 },
}

#[derive(Debug, Deserialize)]
#[serde(tag = "law", rename_all = "kebab-case")]
enum Law {
    Linear { stiffness: Pressure },
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Either {
    Number(f64),
    Many(Vec<f64>),
}

fn faults_of<T: for<'de> Deserialize<'de>>(text: &str) -> Vec<String> {
    let mut sources = Sources(Vec::new());
    sources.add("w.toml", text);
    let (tree, mut faults) = syntax::tree(&sources, 0);
    let known = || vec!["name".to_owned(), "method".to_owned(), "rate".to_owned()];
    if let Some(mut tree) = tree {
        read(&mut tree, &sources, &mut faults, known, |reader| T::deserialize(reader));
    }
    faults.sort_by_key(|fault| fault.location.as_ref().map(|location| location.span.start));
    let more = |text: &Option<String>| text.as_ref().map(|text| format!(" | {text}")).unwrap_or_default();
    faults.iter().map(|fault| format!("{fault}{}{}", more(&fault.label), more(&fault.hint))).collect()
}

#[test]
fn good_values_have_no_fault() {
    let text =
        "a = 1\nb = '1 mm'\nc = [1, 2]\ne = 'least-squares'\nf = { k = 1, l = 2.5 }\nd = { x = true, y = '1 Pa' }";
    assert_eq!(faults_of::<Everything>(text), [""; 0]);
    let text = "a = 1\nb = '1 mm'\nc = []\nf = {}\n[e]\nridge = { lambda = 1 }";
    assert_eq!(faults_of::<Everything>(text), [""; 0]);
    let text =
        "name = 'n'\nmethod = 'genetic'\npopulation = 3\nrate = 0.5\nlaw = { law = 'linear', stiffness = '1 Pa' }";
    assert_eq!(faults_of::<Copied>(&format!("{text}\neither = [1]")), [""; 0]);
}

#[test]
fn every_fault_is_reported_at_its_location() {
    let text = "a = 'x'\nb = 5\nc = [1, -2, 2.5, true]\nd = { x = 1, z = 2 }\ne = 'least-square'\nf = { k = '1' }\ng = [1]\nh = 1";
    let expected = [
        "w.toml:1:5: wanted a number, found the text \"x\"",
        "w.toml:2:5: wanted a length with its unit, such as \"0.5 mm\", found the number 5",
        "w.toml:3:9: wanted a whole number from 0 to 4294967295, found the number -2",
        "w.toml:3:13: wanted a whole number from 0 to 4294967295, found the number 2.5",
        "w.toml:3:18: wanted a whole number from 0 to 4294967295, found true",
        "w.toml:4:5: missing key `y` | `y` is needed here",
        "w.toml:4:11: wanted true or false, found the number 1",
        "w.toml:4:14: unknown key `z` | known keys: `x`, `y`",
        "w.toml:5:5: `least-square` is not one of the known words | did you mean `least-squares`? | known words: `least-squares`, `ridge`",
        "w.toml:6:11: wanted a number, found the text \"1\" | write it without quotes: 1",
        "w.toml:7:5: wanted a list of 2 values, found a list of 1 value",
        "w.toml:8:1: unknown key `h` | known keys: `a`, `b`, `c`, `d`, `e`, `f`, `g`",
    ];
    assert_eq!(faults_of::<Everything>(text), expected);
}

#[test]
fn all_missing_keys_are_reported() {
    let missing = |key: &str| format!("w.toml:1:1: missing key `{key}` | `{key}` is needed here");
    assert_eq!(faults_of::<Everything>(""), ["a", "b", "c", "e", "f"].map(missing));
}

#[test]
fn faults_in_copied_tables_are_told_at_their_place_too() {
    let text = "name = 3\nmethod = 'genetik'\npopulation = 'many'\nlaw = { law = 'linear', stiffness = '1 mm' }\neither = true";
    let expected = [
        "w.toml:1:8: wanted a text in quotes, found the number 3",
        "w.toml:2:10: `genetik` is not one of the known words | did you mean `genetic`? | known words: `genetic`, `annealing`",
        "w.toml:4:37: `mm` is not a unit of stress or modulus; write for example \"16 GPa\"",
        "w.toml:5:10: wanted a value of another form, found true",
    ];
    assert_eq!(faults_of::<Copied>(text), expected);
    let text = text.replace("genetik", "genetic").replace("3", "'n'");
    let expected = [
        "w.toml:3:14: wanted a whole number from 0 to 4294967295, found the text \"many\"",
        "w.toml:4:37: `mm` is not a unit of stress or modulus; write for example \"16 GPa\"",
        "w.toml:5:10: wanted a value of another form, found true",
    ];
    assert_eq!(faults_of::<Copied>(&text), expected);
}

#[test]
fn unknown_keys_of_copied_tables_are_reported() {
    let text = "name = 'n'\nmethod = 'genetic'\npopulation = 3\nrat = 0.5\nlaw = { law = 'linear', stiffness = '1 Pa', x = 1 }";
    let expected = [
        "w.toml:4:1: unknown key `rat` | did you mean `rate`? | known keys: `name`, `method`, `rate`",
        "w.toml:5:45: unknown key `x`",
    ];
    assert_eq!(faults_of::<Copied>(text), expected);
}
