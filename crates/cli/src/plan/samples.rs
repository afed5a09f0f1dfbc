//! The set-points of plans, scan by scan.

use crate::exit::Failure;
use crate::json::number;
use crate::plan::methods::Planned;
use crate::table;
use standstill_planner::{GridPlan, OnlinePlan, RampPlan, SampledPlan, Setpoint, Shapers, UnequalPlan};
use standstill_script::suite::shown;
use standstill_trace::file::Draft;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The convention first, then the names of the columns.
const HEADER: &str = "\
# row n: the plan n*Ts after its start; row 0 is the start; snap (below order 4 the highest limited derivative, too) is the one just before that instant
id,scan,position,velocity,acceleration,jerk,snap
";

/// The source of a plan's set-points.
#[derive(Clone, Debug, PartialEq)]
pub enum Setpoints {
    /// A grid plan.
    Grid(GridPlan),
    /// A grid plan with two rates.
    Unequal(UnequalPlan),
    /// A ramp to a velocity.
    Ramp(Box<RampPlan>),
    /// Plans that follow each other, each with the scan in which it begins; never empty.
    Online(Vec<(u32, OnlinePlan)>),
    /// A profile of a paper.
    Sampled(Box<SampledPlan>),
    /// Any of these through shapers.
    Shaped(Box<Setpoints>, Shapers),
}

impl Setpoints {
    /// The set-point `scan` scans after the start.
    pub fn at(&self, scan: u32) -> Setpoint {
        match self {
            Self::Grid(plan) => plan.at(scan.into()),
            Self::Unequal(plan) => plan.at(scan.into()),
            Self::Ramp(plan) => plan.at(scan.into()),
            Self::Online(plans) => {
                let mut begun = plans.iter().rev().filter(|(begin, _)| *begin <= scan);
                begun
                    .next()
                    .map_or_else(Setpoint::default, |(begin, plan)| plan.at((scan - begin).into()))
            }
            Self::Sampled(plan) => plan.at(scan.into()),
            Self::Shaped(plain, shapers) => {
                // A plan stays at its end.
                let plain = |scan: u64| plain.at(u32::try_from(scan).unwrap_or(u32::MAX));
                shapers.at(scan.into(), plain)
            }
        }
    }
}

/// A CSV file of set-points.
#[derive(Debug)]
pub struct Samples {
    /// The name of the file in messages.
    name: String,
    file: BufWriter<Draft>,
}

impl Samples {
    /// Begins the file with its header.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let name = shown(path);
        let file = Draft::begin(path)?;
        let mut samples = Self {
            name,
            file: BufWriter::new(file),
        };
        samples.checked(|file| file.write_all(HEADER.as_bytes()))?;
        Ok(samples)
    }

    /// Adds a plan, one row for each scan from its start to its end; `id` is JSON.
    pub fn add(&mut self, id: &str, planned: &Planned) -> Result<(), Failure> {
        let id = table::cell_of_json(id);
        self.checked(|file| {
            (0..=planned.scans).try_for_each(|scan| {
                let Setpoint {
                    position,
                    velocity,
                    acceleration,
                    jerk,
                    snap,
                } = planned.setpoints.at(scan);
                let [p, v, a, j, s] = [position, velocity, acceleration, jerk, snap].map(number);
                writeln!(file, "{id},{scan},{p},{v},{a},{j},{s}")
            })
        })
    }

    /// Puts the file into its place.
    pub fn finish(mut self) -> Result<(), Failure> {
        self.checked(BufWriter::flush)?;
        let draft = self.file.into_inner();
        let draft = draft.map_err(|error| Failure::io(&self.name, error.error()))?;
        Ok(draft.keep()?)
    }

    fn checked(
        &mut self,
        write: impl FnOnce(&mut BufWriter<Draft>) -> io::Result<()>,
    ) -> Result<(), Failure> {
        write(&mut self.file).map_err(|error| Failure::io(&self.name, &error))
    }
}
