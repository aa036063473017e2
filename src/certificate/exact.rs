//! Exact arithmetic for tests: whole numbers of 1536 bits, slow and without any rounding.
//!
//! A coordinate in single precision is a whole multiple of 2⁻¹⁴⁹, and below 2¹²⁸: times 2¹⁴⁹ it has at most 277 bits.
//! At an instant of a motion that is a whole number of 1024ths it has ten more. A determinant of three differences then
//! has less than 900 bits. Nothing here can overflow.

use std::ops::{Add, Mul, Sub};

use glam::{DVec3, Vec3A};

const LIMBS: usize = 24;

/// A whole number, in two's complement, lowest limb first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Whole([u64; LIMBS]);

impl Whole {
    pub const ZERO: Self = Self([0; LIMBS]);

    /// `x · 2^shift`, which must be whole.
    pub fn scaled(x: f64, shift: i32) -> Self {
        if x == 0.0 {
            return Self::ZERO;
        }
        let bits = x.abs().to_bits();
        let (exponent, fraction) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
        assert!(exponent > 0 && exponent < 0x7FF, "{x} is no normal number");
        let mut mantissa = fraction | 1 << 52;
        let mut up = exponent - 1075 + shift;
        let spare = mantissa.trailing_zeros() as i32;
        mantissa >>= spare;
        up += spare;
        assert!(up >= 0, "{x} is not a multiple of 2^-{shift}");
        let mut limbs = [0; LIMBS];
        let (limb, bit) = (up as usize / 64, up % 64);
        limbs[limb] = mantissa << bit;
        if bit > 0 {
            limbs[limb + 1] = mantissa >> (64 - bit);
        }
        if x > 0.0 { Self(limbs) } else { Self::ZERO - Self(limbs) }
    }

    /// Its size, rounded.
    pub fn abs_approximately(self) -> f64 {
        let size = if self.sign() < 0 { Self::ZERO - self } else { self };
        size.0.iter().rev().fold(0.0, |sum, &limb| sum * 64.0_f64.exp2() + limb as f64)
    }

    /// −1, 0 or 1.
    pub fn sign(self) -> i8 {
        match self {
            Self::ZERO => 0,
            Self(limbs) if limbs[LIMBS - 1] >> 63 == 1 => -1,
            _ => 1,
        }
    }
}

impl Add for Whole {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let mut carry = 0;
        Self(std::array::from_fn(|k| {
            let sum = u128::from(self.0[k]) + u128::from(other.0[k]) + carry;
            carry = sum >> 64;
            sum as u64
        }))
    }
}

impl Sub for Whole {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + Self(other.0.map(|limb| !limb)) + Self(std::array::from_fn(|k| u64::from(k == 0)))
    }
}

impl Mul for Whole {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let mut limbs = [0_u64; LIMBS];
        for (k, &a) in self.0.iter().enumerate().filter(|(_, a)| **a != 0) {
            let mut carry = 0_u128;
            for (limb, &b) in limbs[k..].iter_mut().zip(&other.0) {
                carry += u128::from(a) * u128::from(b) + u128::from(*limb);
                *limb = carry as u64;
                carry >>= 64;
            }
        }
        Self(limbs)
    }
}

/// A place, in units of 2⁻¹⁵⁹.
pub type Place = [Whole; 3];

/// Where a corner is that moves from one place to another, after so many 1024ths of the motion.
pub fn place([from, to]: [Vec3A; 2], part: u32) -> Place {
    let of = |part: u32| Whole::scaled(f64::from(part), 0);
    std::array::from_fn(|k| {
        let [a, b] = [from, to].map(|p| Whole::scaled(f64::from(p[k]), 149));
        of(1024 - part) * a + of(part) * b
    })
}

/// A place in double precision, which must be a multiple of 2⁻¹⁵⁹.
pub fn place_of(p: DVec3) -> Place {
    p.to_array().map(|x| Whole::scaled(x, 159))
}

fn minus(a: Place, b: Place) -> Place {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: Place, b: Place) -> Place {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Place, b: Place) -> Whole {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Sign of `det[b − a, c − a, d − a]`.
pub fn orientation([a, b, c, d]: [Place; 4]) -> i8 {
    dot(minus(b, a), cross(minus(c, a), minus(d, a))).sign()
}

/// Sign of `((b − a) × (c − a)) · direction`.
pub fn along([a, b, c]: [Place; 3], direction: Place) -> i8 {
    dot(cross(minus(b, a), minus(c, a)), direction).sign()
}

#[test]
fn whole_numbers_are_those_of_128_bits() {
    let numbers = [0.0, 1.0, -1.0, 3.0, -7.0, 1e15, -9e15, 123_456_789.0];
    let wide = |x: f64| x as i128;
    for a in numbers {
        for b in numbers {
            let (of_a, of_b) = (Whole::scaled(a, 70), Whole::scaled(b, 3));
            let (whole, expected) = (of_a * of_b, wide(a) * wide(b));
            assert_eq!(whole.sign(), expected.signum() as i8);
            assert_eq!((of_a - of_a).sign(), 0);
            let [x, y] = [a, b].map(|x| Whole::scaled(x, 0));
            assert_eq!((x * x - y * y).sign(), (wide(a) * wide(a) - wide(b) * wide(b)).signum() as i8);
            assert_eq!((x + y).sign(), (wide(a) + wide(b)).signum() as i8);
        }
    }
    assert_eq!(Whole::scaled(f64::from(f32::MIN_POSITIVE * f32::EPSILON), 149), Whole::scaled(1.0, 0));
}
