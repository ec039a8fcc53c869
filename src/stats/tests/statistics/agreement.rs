//! Ratios and ranks of pairs, against numpy and scipy.

use super::{numbers, reference};
use stats::agreement::agreement;

#[test]
fn ratios_and_ranks_agree_with_numpy_and_scipy() {
    let file = reference("agreement.toml");
    let found = agreement(&numbers(&file["x"]), &numbers(&file["y"])).unwrap();
    let ours = [
        found.quartiles.to_vec(),
        found.extremes.to_vec(),
        vec![found.mean, found.deviation.unwrap()],
        vec![found.spearman.unwrap()],
    ];
    for (ours, name) in ours.iter().zip(["quartiles", "extremes", "mean_and_std", "spearman"]) {
        for (found, wanted) in ours.iter().zip(numbers(&file[name])) {
            assert!((found - wanted).abs() <= 1e-14 * wanted.abs(), "{name}: {found:e} for {wanted:e}");
        }
    }
}
