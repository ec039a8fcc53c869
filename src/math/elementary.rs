//! Elementary functions with the same bits on every machine.
//!
//! The standard library hands `exp`, `sin`, `pow` … to the platform's C library, which may pick another
//! implementation per processor. The `libm` crate is one portable implementation, so a result that went
//! through it can be hashed. `sqrt`, `abs`, `mul_add` and the four operations are exact in IEEE 754 and need no
//! wrapper.

pub use libm::{acos, asin, atan, atan2, cbrt, cos, exp, expm1, log as ln, log1p as ln_1p, log10, pow, sin, tan, tanh};

/// Sine and cosine of one angle in radians.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}
