/// Exponents of mass, length and time that a value is measured in; an angle is a pure number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dimension {
    mass: i8,
    length: i8,
    time: i8,
}

impl Dimension {
    /// A pure number or an angle.
    pub const NONE: Self = Self::new(0, 0, 0);
    /// m
    pub const LENGTH: Self = Self::new(0, 1, 0);
    /// m²
    pub const AREA: Self = Self::new(0, 2, 0);
    /// m⁴
    pub const SECOND_MOMENT: Self = Self::new(0, 4, 0);
    /// kg
    pub const MASS: Self = Self::new(1, 0, 0);
    /// kg/m
    pub const MASS_PER_LENGTH: Self = Self::new(1, -1, 0);
    /// kg/m³
    pub const DENSITY: Self = Self::new(1, -3, 0);
    /// kg m²
    pub const ROTARY_INERTIA: Self = Self::new(1, 2, 0);
    /// s
    pub const TIME: Self = Self::new(0, 0, 1);
    /// 1/s, also of an angle
    pub const RATE: Self = Self::new(0, 0, -1);
    /// 1/s², also of an angle
    pub const ANGULAR_ACCELERATION: Self = Self::new(0, 0, -2);
    /// m/s
    pub const VELOCITY: Self = Self::new(0, 1, -1);
    /// m/s²
    pub const ACCELERATION: Self = Self::new(0, 1, -2);
    /// N
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Pa
    pub const PRESSURE: Self = Self::new(1, -1, -2);
    /// N m, also per angle
    pub const TORQUE: Self = Self::new(1, 2, -2);
    /// N m²
    pub const BENDING_STIFFNESS: Self = Self::new(1, 3, -2);
    /// N m s, also per angle
    pub const VISCOUS_FRICTION: Self = Self::new(1, 2, -1);
    /// W
    pub const POWER: Self = Self::new(1, 2, -3);

    const fn new(mass: i8, length: i8, time: i8) -> Self {
        Self { mass, length, time }
    }

    /// The SI unit as this program writes it; empty for a pure number, and for a dimension in
    /// which this program measures nothing.
    ///
    /// ```
    /// use flexlink::numeric::Dimension;
    /// assert_eq!(Dimension::BENDING_STIFFNESS.si_unit(), "N m^2");
    /// ```
    pub fn si_unit(&self) -> &'static str {
        self.name_and_unit().map_or("", |(_, unit)| unit)
    }

    /// What is measured in this dimension, with its article; `None` where this program measures
    /// nothing in it.
    pub fn name(&self) -> Option<&'static str> {
        self.name_and_unit().map(|(name, _)| name)
    }

    fn name_and_unit(self) -> Option<(&'static str, &'static str)> {
        Some(match self {
            Self::NONE => ("a pure number", ""),
            Self::LENGTH => ("a length", "m"),
            Self::AREA => ("an area", "m^2"),
            Self::SECOND_MOMENT => ("a second moment of area", "m^4"),
            Self::MASS => ("a mass", "kg"),
            Self::MASS_PER_LENGTH => ("a mass per length", "kg/m"),
            Self::DENSITY => ("a density", "kg/m^3"),
            Self::ROTARY_INERTIA => ("a rotary inertia", "kg m^2"),
            Self::TIME => ("a time", "s"),
            Self::RATE => ("a rate", "1/s"),
            Self::ANGULAR_ACCELERATION => ("an angular acceleration", "rad/s^2"),
            Self::VELOCITY => ("a velocity", "m/s"),
            Self::ACCELERATION => ("an acceleration", "m/s^2"),
            Self::FORCE => ("a force", "N"),
            Self::PRESSURE => ("a pressure", "Pa"),
            Self::TORQUE => ("a torque", "N m"),
            Self::BENDING_STIFFNESS => ("a bending stiffness", "N m^2"),
            Self::VISCOUS_FRICTION => ("a viscous friction", "N m s/rad"),
            Self::POWER => ("a power", "W"),
            _ => return None,
        })
    }

    /// The dimension to a power; `None` beyond what any unit needs.
    pub(super) fn power(self, n: i8) -> Option<Self> {
        Some(Self {
            mass: self.mass.checked_mul(n)?,
            length: self.length.checked_mul(n)?,
            time: self.time.checked_mul(n)?,
        })
    }

    /// The dimension of a product, with the same limit.
    pub(super) fn plus(self, other: Self) -> Option<Self> {
        Some(Self {
            mass: self.mass.checked_add(other.mass)?,
            length: self.length.checked_add(other.length)?,
            time: self.time.checked_add(other.time)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Unit;
    use super::*;

    #[test]
    fn the_si_unit_of_each_dimension_has_that_dimension_and_factor_one() {
        let range = -4..=4;
        let all = range.clone().flat_map(|mass| {
            let range = range.clone();
            let lengths =
                range.clone().flat_map(move |length| range.clone().map(move |time| (length, time)));
            lengths.map(move |(length, time)| Dimension::new(mass, length, time))
        });
        let named: Vec<Dimension> = all.filter(|d| !d.si_unit().is_empty()).collect();
        assert_eq!(named.len(), 18);
        for dimension in named {
            let unit = Unit::parse(dimension.si_unit()).unwrap();
            assert_eq!(unit.dimension(), dimension);
            assert_eq!(unit.to_si(3.7).to_bits(), 3.7_f64.to_bits());
        }
    }
}
