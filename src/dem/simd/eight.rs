//! Eight contacts in an AVX-512 register.
//!
//! Every call is sound because [`super::width::dispatch`] is the only way here, and it has asked the processor.

use super::four::{add_to, read, transpose};
use super::{Lane, Quad, Row};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight(__m512d);

macro_rules! operator {
    ($trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for Eight {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the head.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}
operator!(Add, add, _mm512_add_pd);
operator!(Sub, sub, _mm512_sub_pd);
operator!(Mul, mul, _mm512_mul_pd);
operator!(Div, div, _mm512_div_pd);

impl Neg for Eight {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

/// Two halves side by side.
#[inline(always)]
fn join(low: __m256d, high: __m256d) -> Eight {
    // SAFETY: see the head.
    Eight(unsafe { _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low), high) })
}

/// The first and the last four.
#[inline(always)]
fn halves(x: Eight) -> [__m256d; 2] {
    // SAFETY: see the head.
    unsafe { [_mm512_castpd512_pd256(x.0), _mm512_extractf64x4_pd::<1>(x.0)] }
}

/// Four columns as eight rows, in two halves.
#[inline(always)]
fn rows(value: [Eight; 4]) -> [[__m256d; 4]; 2] {
    let [a, b, c, d] = [halves(value[0]), halves(value[1]), halves(value[2]), halves(value[3])];
    [transpose([a[0], b[0], c[0], d[0]]), transpose([a[1], b[1], c[1], d[1]])]
}

impl Lane for Eight {
    type Mask = u8;
    const WIDTH: usize = 8;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    fn load(row: &Row, _at: usize) -> Self {
        // SAFETY: a row is 64 bytes, aligned to 64.
        Self(unsafe { _mm512_load_pd(row.0.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, row: &mut Row, _at: usize) {
        // SAFETY: a row is 64 bytes, aligned to 64.
        unsafe { _mm512_store_pd(row.0.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> u8 {
        // SAFETY: see the head.
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn or(a: u8, b: u8) -> u8 {
        a | b
    }
    #[inline(always)]
    fn select(mask: u8, yes: Self, no: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn bits(mask: u8) -> u8 {
        mask
    }
    #[inline(always)]
    fn gather(table: &[Quad], stride: usize, row: usize, ends: &[u32]) -> [Self; 4] {
        let at = |k: usize| read(&table[ends[k] as usize * stride + row]);
        let low = transpose([at(0), at(1), at(2), at(3)]);
        let high = transpose([at(4), at(5), at(6), at(7)]);
        [join(low[0], high[0]), join(low[1], high[1]), join(low[2], high[2]), join(low[3], high[3])]
    }
    #[inline(always)]
    fn scatter_add(table: &mut [Quad], stride: usize, row: usize, ends: &[u32], value: [Self; 4]) {
        for (half, rows) in rows(value).into_iter().enumerate() {
            for k in 0..4 {
                add_to(&mut table[ends[4 * half + k] as usize * stride + row], rows[k]);
            }
        }
    }
    #[inline(always)]
    fn scatter_add_both(table: &mut [Quad], stride: usize, row: usize, ends: [&[u32]; 2], value: [[Self; 4]; 2]) {
        let [first, second] = [rows(value[0]), rows(value[1])];
        for half in 0..2 {
            for k in 0..4 {
                add_to(&mut table[ends[0][4 * half + k] as usize * stride + row], first[half][k]);
                add_to(&mut table[ends[1][4 * half + k] as usize * stride + row], second[half][k]);
            }
        }
    }
}
