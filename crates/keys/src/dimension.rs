//! What kind of quantity a key holds, and the units for it.

/// What kind of quantity a number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A number or a share without a unit; a share may be written in percent.
    One,
    /// Metres.
    Length,
    /// Pascals.
    Stress,
    /// Pascals per metre: stiffness of a fracture, gradient of a stress.
    StressPerLength,
    /// Joules per square metre.
    EnergyPerArea,
    /// Kilograms per cubic metre.
    Density,
    /// Metres per second squared.
    Acceleration,
    /// Pascal seconds.
    Viscosity,
    /// Cubic metres per second.
    VolumeRate,
    /// Area per volume, 1/m.
    PerLength,
    /// Relative change with pressure, 1/Pa.
    PerStress,
    /// A velocity times the root of a time, m/s^0.5.
    Leakoff,
    /// Degrees.
    Angle,
    /// Bytes.
    Memory,
    /// A time in a unit that the user chooses: nothing depends on rates.
    Time,
    /// That of the key which is swept.
    OfKey,
}

/// Powers of metre, kilogram and second.
pub(crate) type Exponents = [i32; 3];

impl Dimension {
    /// All that a unit can have.
    pub(crate) const WITH_UNITS: [Self; 13] = [
        Self::One,
        Self::Length,
        Self::Stress,
        Self::StressPerLength,
        Self::EnergyPerArea,
        Self::Density,
        Self::Acceleration,
        Self::Viscosity,
        Self::VolumeRate,
        Self::PerLength,
        Self::PerStress,
        Self::Angle,
        Self::Memory,
    ];

    /// What messages call a quantity of it, with an article.
    pub fn name(self) -> &'static str {
        match self {
            Self::One => "a number without a unit",
            Self::Length => "a length",
            Self::Stress => "a stress",
            Self::StressPerLength => "a stress per length",
            Self::EnergyPerArea => "an energy per area",
            Self::Density => "a density",
            Self::Acceleration => "an acceleration",
            Self::Viscosity => "a viscosity",
            Self::VolumeRate => "a rate of volume",
            Self::PerLength => "an area per volume",
            Self::PerStress => "a compressibility",
            Self::Leakoff => "a leak-off coefficient",
            Self::Angle => "an angle",
            Self::Memory => "an amount of memory",
            Self::Time => "a time in a unit of your own",
            Self::OfKey => "as the key that is swept",
        }
    }

    /// The unit of plain numbers; empty if there is none.
    pub fn unit(self) -> &'static str {
        match self {
            Self::One => "",
            Self::Length => "m",
            Self::Stress => "Pa",
            Self::StressPerLength => "Pa/m",
            Self::EnergyPerArea => "J/m2",
            Self::Density => "kg/m3",
            Self::Acceleration => "m/s2",
            Self::Viscosity => "Pa s",
            Self::VolumeRate => "m3/s",
            Self::PerLength => "1/m",
            Self::PerStress => "1/Pa",
            Self::Leakoff => "m/s^0.5",
            Self::Angle => "degrees",
            Self::Memory => "bytes",
            Self::Time => "time",
            Self::OfKey => "of the key",
        }
    }

    /// Units that are commonly written for it; empty if a text is no way to write it.
    pub fn units(self) -> &'static [&'static str] {
        match self {
            Self::One => &["%"],
            Self::Length => &["m", "um", "mm", "cm", "km"],
            Self::Stress => &["Pa", "kPa", "MPa", "GPa", "bar"],
            Self::StressPerLength => &["Pa/m", "kPa/m", "MPa/m", "GPa/m", "MPa/mm", "MPa/km"],
            Self::EnergyPerArea => &["J/m2", "kJ/m2", "N/m"],
            Self::Density => &["kg/m3", "g/cm3", "t/m3"],
            Self::Acceleration => &["m/s2", "cm/s2"],
            Self::Viscosity => &["Pa s", "mPa s"],
            Self::VolumeRate => &["m3/s", "dm3/s", "cm3/s"],
            Self::PerLength => &["1/m", "m2/m3", "1/km"],
            Self::PerStress => &["1/Pa", "1/MPa", "1/GPa"],
            Self::Angle => &["degrees", "deg", "rad"],
            Self::Memory => &["B", "kB", "MB", "GB", "TB", "MiB", "GiB"],
            Self::Leakoff | Self::Time | Self::OfKey => &[],
        }
    }

    /// Powers of metre, kilogram and second, of what has them.
    pub(crate) fn exponents(self) -> Option<Exponents> {
        match self {
            Self::Length => Some([1, 0, 0]),
            Self::Stress => Some([-1, 1, -2]),
            Self::StressPerLength => Some([-2, 1, -2]),
            Self::EnergyPerArea => Some([0, 1, -2]),
            Self::Density => Some([-3, 1, 0]),
            Self::Acceleration => Some([1, 0, -2]),
            Self::Viscosity => Some([-1, 1, -1]),
            Self::VolumeRate => Some([3, 0, -1]),
            Self::PerLength => Some([-1, 0, 0]),
            Self::PerStress => Some([1, -1, 2]),
            Self::One | Self::Leakoff | Self::Angle | Self::Memory | Self::Time | Self::OfKey => {
                None
            }
        }
    }
}
