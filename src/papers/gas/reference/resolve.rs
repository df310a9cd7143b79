//! The colour of a pixel's list, in double precision: 32 sub-pixels, each composited alone (section "Combining A-buffer
//! and volume rendering techniques", and Carpenter's A-buffer).

use glam::DVec3;

/// A fragment of a surface as it is lit, or a section of gas.
#[derive(Debug, Clone, Copy)]
pub enum Layer {
    Surface {
        /// A bit for each of the 32 sub-pixels that it covers.
        mask: u32,
        /// Nearest and farthest depth, metres.
        depth_m: [f64; 2],
        /// Number of its object: fragments of one object do not intersect each other.
        object: u32,
        /// Fraction of the light from behind that it takes away, 0 to 1.
        opacity: f64,
        /// Linear RGB, not premultiplied.
        color: DVec3,
    },
    /// Of every sub-pixel; premultiplied.
    Gas { color: DVec3, transparency: f64 },
}

/// Linear RGB of a pixel whose list is sorted from the eye on.
pub fn composited(layers: &[Layer], background: DVec3) -> DVec3 {
    (0..32).map(|bit| sub_pixel(layers, 1 << bit, background)).sum::<DVec3>() / 32.0
}

fn sub_pixel(layers: &[Layer], bit: u32, background: DVec3) -> DVec3 {
    let (mut sum, mut left) = (DVec3::ZERO, 1.0);
    for (i, layer) in layers.iter().enumerate() {
        match *layer {
            Layer::Gas { color, transparency } => {
                sum += color * left;
                left *= transparency;
            }
            Layer::Surface { mask, opacity, color, .. } if mask & bit != 0 => {
                let neighbour = layers[i + 1..].iter().find(|l| matches!(l, Layer::Surface { .. }));
                let (fraction, other) = neighbour.map_or((0.0, DVec3::ZERO), |next| shown(layer, next, bit));
                sum += (color * (1.0 - fraction) + other * fraction) * (opacity * left);
                left *= 1.0 - opacity;
            }
            Layer::Surface { .. } => {}
        }
    }
    sum + background * left
}

/// The fraction in which a fragment shows the one after it where they intersect, and the colour of that one: Carpenter
/// sees the front one in (far of the other - near) over the sum of both thicknesses.
fn shown(front: &Layer, behind: &Layer, bit: u32) -> (f64, DVec3) {
    let (
        Layer::Surface { depth_m: [near, far], object, .. },
        Layer::Surface { mask, depth_m: [other_near, other_far], object: other, opacity, color },
    ) = (*front, *behind)
    else {
        return (0.0, DVec3::ZERO);
    };
    if mask & bit == 0 || object == other || other_near >= far {
        return (0.0, DVec3::ZERO);
    }
    let seen = ((other_far - near) / (far - near + other_far - other_near)).clamp(0.0, 1.0);
    ((1.0 - seen) * opacity, color)
}
