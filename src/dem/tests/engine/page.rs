//! The validation page is what the tests compute.

use crate::case::Family;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/engine/VALIDATION.md");

const HEAD: &str = "# The engine against closed forms

Every row is computed by `cargo test --test engine`, which also fails when this page differs from what is computed;
`cargo test --test engine -- --ignored write` writes it anew. SI units; discs have unit thickness. \"off\" is the relative
deviation unless the allowed one is absolute. The runs are small: what they show is that the equations are solved, not how
a real specimen behaves. The same rows come out on every x86-64 machine and in every build profile, because the engine's
bits do.

Sources: CS79 = Cundall & Strack (1979), doi:10.1680/geot.1979.29.1.47; PC04 = Potyondy & Cundall (2004),
doi:10.1016/j.ijrmms.2004.09.011; PFC = documentation of PFC 5 and later. \"exact\" means a closed form derived in the head
of the test's file.
";

fn families() -> Vec<Family> {
    vec![
        crate::impact::family(),
        crate::friction::family(),
        crate::rest::family(),
        crate::stiffness::family(),
        crate::incremental::family(),
        crate::bond::family(),
        crate::flat_joint::family(),
        crate::smooth_joint::family(),
        crate::strength::family(),
        crate::beam::family(),
        crate::bending::family(),
        crate::lattice::family(),
        crate::platens::family(),
        crate::measuring::family(),
        crate::disc::family(),
        crate::packing::family(),
        crate::step::family(),
        crate::limit::family(),
        crate::clump::family(),
        crate::balance::family(),
        crate::invariance::family(),
        crate::turned::family(),
        crate::scaling::family(),
        crate::energy::family(),
        crate::curve::family(),
        crate::genesis::family(),
        crate::moduli::family(),
        crate::periodic::family(),
    ]
}

fn page() -> String {
    families().iter().fold(HEAD.to_owned(), |page, family| page + &family.section())
}

#[test]
fn the_page_says_what_is_computed() {
    let found = std::fs::read_to_string(PAGE).unwrap_or_default();
    let computed = page();
    for (old, new) in found.lines().zip(computed.lines()) {
        assert_eq!(old, new, "write the page anew: cargo test --test engine -- --ignored write");
    }
    assert_eq!(found.len(), computed.len(), "write the page anew: cargo test --test engine -- --ignored write");
}

#[test]
#[ignore = "writes the page; run by hand after a change of the cases"]
fn write() {
    std::fs::write(PAGE, page()).unwrap();
}
