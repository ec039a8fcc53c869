use super::*;

#[test]
fn a_barred_symbol_with_subscript_and_unit() {
    let line = Line::new(&quantity("", r"\bar\sigma_c", "MPa"), 10.0);
    assert_eq!(line.plain, "σ\u{304}_c / MPa");
    let [sigma, c, space, ..] = &line.glyphs[..] else { panic!("too few glyphs") };
    assert_eq!((sigma.face, sigma.character), (Face::Italic, 'σ'));
    assert_eq!((c.face, c.character), (Face::Regular, 'c'));
    assert!(c.size < sigma.size && c.at[1] > 0.0 && space.at[1] == 0.0);
    let bar = line.rules[0];
    let top = -Face::Italic.extent(sigma.id)[3] * 10.0;
    assert!(bar.bottom < top && bar.left >= sigma.at[0] - 0.5 && bar.right <= c.at[0] + 1.0);
}

#[test]
fn scripts_stand_over_one_another() {
    let line = Line::new(r"$R^2_{adj}$", 10.0);
    let at = |c| line.glyphs.iter().find(|g| g.character == c).map(|g| g.at).unwrap();
    assert!(at('2')[1] < 0.0 && at('a')[1] > 0.0 && (at('2')[0] - at('a')[0]).abs() < 1.0);
}

#[test]
fn minus_and_units() {
    assert_eq!(Line::new("$10^{-3}$", 1.0).plain, "10⁻³");
    assert_eq!(unit_markup("kg/m^3"), "kg/m$^{3}$");
    assert_eq!(quantity("Density", r"\rho", "kg/m^3"), r"Density $\rho$ / (kg/m$^{3}$)");
    assert_eq!(Line::new("Density / (kg/m$^3$)", 1.0).plain, "Density / (kg/m³)");
}

#[test]
fn faults_are_named() {
    assert_eq!(check(r"strain $\varepsilon_{1}$ / %"), Ok(()));
    assert!(check(r"$\sigm_c$").unwrap_err().to_string().contains(r"unknown command `\sigm`"));
    assert!(matches!(check("$E_{c$"), Err(LabelError::Unpaired { .. })));
    assert!(matches!(check("$E_c"), Err(LabelError::Unpaired { sign: '$', .. })));
    assert!(matches!(check("力"), Err(LabelError::Character { character: '力', .. })));
}

#[test]
fn a_turned_line_takes_a_tall_place() {
    let line = Line::new("Strength", 3.0);
    let r = line.bounds([10.0, 50.0], 90.0);
    assert!((r.height() - line.width).abs() < 1e-9 && (r.bottom - 50.0).abs() < 1e-9);
    assert!((r.right - 10.0 - line.below).abs() < 1e-9 && (10.0 - r.left - line.above).abs() < 1e-9);
}

#[test]
fn a_quotient_takes_brackets_before_a_power() {
    assert!(["k_n/k_s", "a b", "a^2"].into_iter().all(is_compound));
    assert!(["(k_n/k_s)_j", r"\bar\sigma_c", r"\sigma_{c, 1}", "E_c"].into_iter().all(|symbol| !is_compound(symbol)));
}
