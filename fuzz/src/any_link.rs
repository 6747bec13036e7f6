use arbitrary::{Result, Unstructured};
use flexlink::link::{
    Damping, Drive, Hub, LinkParts, LumpedMass, Payload, Segment, Taper, Timoshenko,
};

/// A link of any make, its bodies and stiffnesses over many orders of magnitude.
///
/// # Errors
/// Those of `u`, which end the input.
pub fn any_link(u: &mut Unstructured) -> Result<LinkParts> {
    let segments: Vec<Segment> =
        (0..u.int_in_range(1..=4)?).map(|_| any_segment(u)).collect::<Result<_>>()?;
    let hub = Hub {
        inertia_kg_m2: any_or_none(u, 30)?,
        radius_m: any_or_none(u, 10)?,
        viscous_friction_n_m_s_rad: any_or_none(u, 30)?,
    };
    let masses = (0..u.int_in_range(0..=3)?).map(|_| any_mass(u, &segments, hub.radius_m));
    Ok(LinkParts {
        title: String::new(),
        masses: masses.collect::<Result<_>>()?,
        segments,
        hub,
        carriage: None,
        root_stiffness_n_m_rad: None,
        output_m: None,
        payload: Payload {
            mass_kg: any_or_none(u, 30)?,
            inertia_kg_m2: any_or_none(u, 30)?,
            offset_m: any_or_none(u, 10)? * f64::from(u.int_in_range(-1..=1)?),
        },
        damping: any_damping(u)?,
        drive: any_drive(u)?,
        gravity: None,
    })
}

/// A drive, or none.
fn any_drive(u: &mut Unstructured) -> Result<Option<Drive>> {
    if !u.arbitrary()? {
        return Ok(None);
    }
    let stiffness = any_or_none(u, 30)?;
    Ok(Some(Drive {
        joint_stiffness_n_m_rad: if stiffness > 0.0 { stiffness } else { f64::INFINITY },
        rotor_inertia_kg_m2: any_or_none(u, 30)?,
        gear_ratio: any_size(u, 10)?,
        coulomb_friction_n_m: any_or_none(u, 30)?,
        ..Drive::DIRECT
    }))
}

fn any_segment(u: &mut Unstructured) -> Result<Segment> {
    let taper = |u: &mut Unstructured, inner: f64| {
        Ok(Taper { inner, outer: if u.arbitrary()? { inner } else { inner * any_size(u, 6)? } })
    };
    let (length_m, stiffness, mass) = (any_size(u, 8)?, any_size(u, 30)?, any_or_none(u, 20)?);
    Ok(Segment {
        name: None,
        length_m,
        bending_stiffness_n_m2: taper(u, stiffness)?,
        mass_per_length_kg_m: taper(u, mass)?,
        cross_section: None,
        timoshenko: any_shear(u)?,
    })
}

/// Shear and rotary inertia, or none.
fn any_shear(u: &mut Unstructured) -> Result<Option<Timoshenko>> {
    if !u.arbitrary()? {
        return Ok(None);
    }
    Ok(Some(Timoshenko {
        shear_stiffness_n: Taper::constant(any_size(u, 30)?),
        rotary_inertia_per_length_kg_m: Taper::constant(any_or_none(u, 20)?),
    }))
}

/// A lumped mass at eighths of a segment.
fn any_mass(u: &mut Unstructured, segments: &[Segment], radius_m: f64) -> Result<LumpedMass> {
    let segment = u.choose_index(segments.len())?;
    let inner_m: f64 = segments[..segment].iter().map(|segment| segment.length_m).sum();
    let eighths = f64::from(u.int_in_range(0..=8)?);
    Ok(LumpedMass {
        at_m: radius_m + inner_m + segments[segment].length_m * eighths / 8.0,
        mass_kg: any_or_none(u, 30)?,
        inertia_kg_m2: any_or_none(u, 30)?,
    })
}

fn any_damping(u: &mut Unstructured) -> Result<Damping> {
    let ratio = |u: &mut Unstructured| Ok(f64::from(u.arbitrary::<u8>()?) / 512.0);
    let ratios = |u: &mut Unstructured| -> Result<Vec<f64>> {
        (0..u.int_in_range(1..=4)?).map(|_| ratio(u)).collect()
    };
    Ok(match u.int_in_range(0..=5)? {
        0 => Damping::None,
        1 => Damping::Rayleigh { alpha_per_s: any_or_none(u, 20)?, beta_s: any_or_none(u, 20)? },
        2 => {
            let low = u.int_in_range(1..=3)?;
            let modes = [low, low + u.int_in_range(1..=3)?];
            Damping::RayleighThroughModes { modes, ratios: [ratio(u)?, ratio(u)?] }
        }
        3 => Damping::Modal { ratios: ratios(u)? },
        4 => {
            let ratios = ratios(u)?;
            Damping::Caughey { modes: (1..=ratios.len()).collect(), ratios }
        }
        _ => Damping::Hysteretic { ratio: ratio(u)? },
    })
}

/// Nothing, or a number as [`any_size`] has it.
fn any_or_none(u: &mut Unstructured, binary_orders: i32) -> Result<f64> {
    if u.arbitrary()? { any_size(u, binary_orders) } else { Ok(0.0) }
}

/// A number within so many powers of two of 1.
///
/// # Errors
/// Those of `u`.
pub fn any_size(u: &mut Unstructured, binary_orders: i32) -> Result<f64> {
    let mantissa = 1.0 + f64::from(u.arbitrary::<u8>()?) / 256.0;
    Ok(mantissa * 2.0_f64.powi(u.int_in_range(-binary_orders..=binary_orders)?))
}
