//! Putting a runtime together.

use super::{BlockId, Blocks, Ready};
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use standstill_axis::{AxisConfig, AxisId, Drive, IdealDrive, InstanceId, Standard};
use standstill_blocks::BlockInstance;
use standstill_fb::{BlockInfo, Described, Record, TableRef};
use standstill_record::{Recorder, Setup, Signals};
use standstill_scan::{ConfigError, Executor, Machine, MachineError, ProgramConfig, TaskConfig};

/// A runtime under construction. Everything here may use the heap; nothing later does.
#[derive(Debug)]
pub struct Builder<D: Drive = IdealDrive> {
    cycle_ns: u64,
    machine: Machine<Standard, D>,
    /// Name, label of the unit, configuration.
    axes: Vec<(String, String, AxisConfig)>,
    blocks: Blocks,
    own: Vec<(String, InstanceId, &'static BlockInfo)>,
    tasks: Vec<TaskConfig>,
    programs: Vec<ProgramConfig>,
    recorder: Option<Setup>,
}

/// Why something cannot be part of a runtime.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// Two axes or instances have the same name, without regard to case. Traces identify them by name.
    Name {
        /// The name.
        name: String,
    },
    /// The configuration of an axis is not valid.
    Axis {
        /// Its name.
        name: String,
        /// What is wrong.
        why: MachineError,
    },
    /// There is no such block.
    UnknownBlock {
        /// The instance.
        name: String,
        /// The block it should be an instance of.
        block: String,
    },
    /// Instance numbers have 16 bits, and none is left.
    TooManyBlocks,
    /// A table has more records than its reference can count, or all tables together have too many
    /// numbers.
    TableTooLong {
        /// Its records.
        records: usize,
    },
    /// The declarations of tasks and programs do not fit together, or the cycle is 0.
    Tasks(ConfigError),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name { name } => write!(
                f,
                "the name {name} is taken: axes and instances share one set of names, without regard to case"
            ),
            Self::Axis { name, why } => write!(f, "axis {name}: {why}"),
            Self::UnknownBlock { name, block } => write!(
                f,
                "{name}: there is no block {block}; standstill::REGISTRY lists those there are"
            ),
            Self::TooManyBlocks => write!(f, "a runtime has at most 65534 block instances: use a second one"),
            Self::TableTooLong { records } => write!(f, "a table of {records} records: 65535 at most"),
            Self::Tasks(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BuildError {}

impl From<ConfigError> for BuildError {
    fn from(error: ConfigError) -> Self {
        Self::Tasks(error)
    }
}

impl<D: Drive> Builder<D> {
    /// A runtime without axes that is scanned every `cycle_ns` (ns).
    pub fn new(cycle_ns: u64) -> Self {
        Self {
            cycle_ns,
            machine: Machine::new(),
            axes: Vec::new(),
            blocks: Blocks::default(),
            own: Vec::new(),
            tasks: Vec::new(),
            programs: Vec::new(),
            recorder: None,
        }
    }

    /// Adds an axis over its drive; `unit` is a label for people, such as `mm`.
    ///
    /// # Errors
    /// [`BuildError::Name`], [`BuildError::Axis`].
    pub fn axis(
        &mut self,
        name: &str,
        unit: &str,
        config: AxisConfig,
        drive: D,
    ) -> Result<AxisId, BuildError> {
        self.check(name)?;
        let planner = Standard::new(self.cycle_ns as f64 / 1e9);
        let id = self.machine.add_axis(config, planner, drive);
        let id = id.map_err(|why| BuildError::Axis {
            name: name.into(),
            why,
        })?;
        self.axes.push((name.into(), unit.into(), config));
        Ok(id)
    }

    /// Adds an instance that belongs to the runtime. `block` is an IEC name, without regard to case.
    ///
    /// # Errors
    /// [`BuildError::Name`], [`BuildError::UnknownBlock`], [`BuildError::TooManyBlocks`].
    pub fn block(&mut self, name: &str, block: &str) -> Result<BlockId, BuildError> {
        self.check(name)?;
        let instance = BlockInstance::new(block).ok_or_else(|| BuildError::UnknownBlock {
            name: name.into(),
            block: block.into(),
        })?;
        let number = self.number()?;
        self.blocks
            .add(name, number, instance)
            .ok_or(BuildError::TooManyBlocks)
    }

    /// Declares an instance that the host keeps in its own struct, so that records and the recorder know it.
    /// The host sets `context.scope.instance` to the returned number before each call.
    ///
    /// # Errors
    /// [`BuildError::Name`], [`BuildError::TooManyBlocks`].
    pub fn own_block<B: Described>(&mut self, name: &str) -> Result<InstanceId, BuildError> {
        self.check(name)?;
        let number = self.number()?;
        self.own.push((name.into(), number, &B::INFO));
        Ok(number)
    }

    /// Adds a table for a block pin that refers to one.
    ///
    /// # Errors
    /// [`BuildError::TableTooLong`].
    pub fn table<R: Record>(&mut self, records: &[R]) -> Result<TableRef, BuildError> {
        let table = self.machine.add_table(records);
        table.ok_or(BuildError::TableTooLong {
            records: records.len(),
        })
    }

    /// Adds a task. Its number is its index among the tasks.
    pub fn task(&mut self, task: TaskConfig) -> &mut Self {
        self.tasks.push(task);
        self
    }

    /// Adds a program instance. Its number is its index among the programs. A runtime without any has
    /// one, `main`, that runs in every scan.
    pub fn program(&mut self, program: ProgramConfig) -> &mut Self {
        self.programs.push(program);
        self
    }

    /// Records the last scans around a trigger. Memory: 8 bytes for each signal and scan. Each pin is a
    /// signal, and each axis has seven.
    pub fn record(&mut self, setup: Setup) -> &mut Self {
        self.recorder = Some(setup);
        self
    }

    /// Runs all checks that need the whole, and allocates the remaining memory.
    ///
    /// # Errors
    /// [`BuildError::Tasks`].
    pub fn ready(self) -> Result<Ready<D>, BuildError> {
        let main = [ProgramConfig::free("main")];
        let programs = if self.programs.is_empty() {
            &main[..]
        } else {
            &self.programs
        };
        let executor = Executor::new(self.cycle_ns, &self.tasks, programs)?;
        let recorder = self.recorder.map(|setup| {
            let mut signals = Signals::new();
            for (name, unit, config) in &self.axes {
                signals = signals.axis(name, unit, config);
            }
            for (name, number, instance) in self.blocks.named() {
                signals = signals.instance(name, number.0, standstill_fb::AnyInstance::info(instance));
            }
            for (name, number, block) in &self.own {
                signals = signals.instance(name, number.0, block);
            }
            Recorder::new(setup, signals)
        });
        Ok(Ready {
            executor,
            machine: self.machine,
            blocks: self.blocks,
            recorder,
        })
    }

    /// The next number for records; 0 is for records that no instance of the runtime causes.
    fn number(&self) -> Result<InstanceId, BuildError> {
        let count = self.blocks.instances().count() + self.own.len();
        let number = u16::try_from(count + 1).ok().map(InstanceId);
        number
            .filter(|number| *number != standstill_scan::RUNTIME)
            .ok_or(BuildError::TooManyBlocks)
    }

    fn check(&self, name: &str) -> Result<(), BuildError> {
        let axes = self.axes.iter().map(|(name, ..)| name.as_str());
        let blocks = self.blocks.named().map(|(name, ..)| name);
        let own = self.own.iter().map(|(name, ..)| name.as_str());
        let mut all = axes.chain(blocks).chain(own);
        match all.find(|known| known.eq_ignore_ascii_case(name)) {
            Some(_) => Err(BuildError::Name { name: name.into() }),
            None => Ok(()),
        }
    }
}
