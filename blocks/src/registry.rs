//! Every block the runtime knows, by its IEC name.

use standstill_axis::Planner;
use standstill_fb::flat::Pointer;
use standstill_fb::{AnyInstance, BlockInfo, Context, Described, Instance, PinError, Value};

/// Calls the macro `$then` with every block of the registry: its type and its path in this crate. The
/// last name of the path is the block's name in C.
#[macro_export]
macro_rules! for_every_block {
    ($then:ident) => {
        $then! {
            administrative::mc_power::McPower
            administrative::mc_reset::McReset
            administrative::mc_read_status::McReadStatus
            administrative::mc_read_motion_state::McReadMotionState
            administrative::mc_read_axis_info::McReadAxisInfo
            administrative::mc_read_axis_error::McReadAxisError
            administrative::mc_read_actual_position::McReadActualPosition
            administrative::mc_read_actual_velocity::McReadActualVelocity
            administrative::mc_read_actual_torque::McReadActualTorque
            administrative::mc_set_position::McSetPosition
            administrative::mc_set_override::McSetOverride
            administrative::mc_read_parameter::McReadParameter
            administrative::mc_read_bool_parameter::McReadBoolParameter
            administrative::mc_write_parameter::McWriteParameter
            administrative::mc_write_bool_parameter::McWriteBoolParameter
            administrative::mc_read_digital_input::McReadDigitalInput
            administrative::mc_read_digital_output::McReadDigitalOutput
            administrative::mc_write_digital_output::McWriteDigitalOutput
            administrative::mc_touch_probe::McTouchProbe
            administrative::mc_abort_trigger::McAbortTrigger
            administrative::mc_digital_cam_switch::McDigitalCamSwitch
            homing::mc_home::McHome
            single_axis::mc_stop::McStop
            single_axis::mc_halt::McHalt
            single_axis::mc_move_absolute::McMoveAbsolute
            single_axis::mc_move_relative::McMoveRelative
            single_axis::mc_move_additive::McMoveAdditive
            single_axis::mc_move_velocity::McMoveVelocity
            single_axis::mc_move_continuous_absolute::McMoveContinuousAbsolute
            single_axis::mc_move_continuous_relative::McMoveContinuousRelative
            single_axis::mc_torque_control::McTorqueControl
            single_axis::mc_position_profile::McPositionProfile
            single_axis::mc_velocity_profile::McVelocityProfile
            single_axis::mc_acceleration_profile::McAccelerationProfile
            single_axis::mc_move_superimposed::McMoveSuperimposed
            single_axis::mc_halt_superimposed::McHaltSuperimposed
            single_axis::mc_jog::McJog
            multi_axis::mc_cam_table_select::McCamTableSelect
            multi_axis::mc_cam_in::McCamIn
            multi_axis::mc_cam_out::McCamOut
            multi_axis::mc_gear_in::McGearIn
            multi_axis::mc_gear_out::McGearOut
            multi_axis::mc_gear_in_pos::McGearInPos
            multi_axis::mc_phasing_absolute::McPhasingAbsolute
            multi_axis::mc_phasing_relative::McPhasingRelative
            multi_axis::mc_combine_axes::McCombineAxes
            standard::r_trig::RTrig
            standard::f_trig::FTrig
            standard::sr::Sr
            standard::rs::Rs
            standard::ctu::Ctu
            standard::ctd::Ctd
            standard::ctud::Ctud
            standard::ton::Ton
            standard::tof::Tof
            standard::tp::Tp
        }
    };
}

macro_rules! registry {
    ($($group:ident :: $module:ident :: $block:ident)*) => {
        $(use crate::$group::$module::$block;)*

        /// An instance of any block of the registry.
        // The variants differ in size, and a box would need a heap.
        #[allow(clippy::large_enum_variant)]
        #[derive(Clone, Copy, Debug)]
        pub enum BlockInstance {
            $(#[doc = concat!("An instance of [`", stringify!($block), "`].")] $block(Instance<$block>),)*
        }

        /// Every block as data, in catalogue order.
        // Not a constant: otherwise each crate that uses it would contain a copy of all tables and texts.
        pub static REGISTRY: &[BlockInfo] = &[$(<$block as Described>::INFO),*];

        impl BlockInstance {
            /// A new instance of the block called `name`, without regard to case.
            pub fn new(name: &str) -> Option<Self> {
                $(
                    if <$block as Described>::INFO.name.eq_ignore_ascii_case(name) {
                        return Some(Self::$block(Instance::default()));
                    }
                )*
                None
            }

            /// Calls the block with its present inputs.
            pub fn call<P: Planner>(&mut self, context: &mut Context<'_, P>) {
                match self { $(Self::$block(instance) => instance.call(context),)* }
            }

            fn any(&self) -> &dyn AnyInstance {
                match self { $(Self::$block(instance) => instance,)* }
            }

            fn any_mut(&mut self) -> &mut dyn AnyInstance {
                match self { $(Self::$block(instance) => instance,)* }
            }
        }
    };
}

for_every_block!(registry);

/// Compiles the code of all blocks for axes with the common planner here. In builds with little optimisation,
/// crates that call blocks use it instead of compiling a copy each.
#[cfg(all(debug_assertions, not(test)))]
#[used]
static CALL: fn(&mut BlockInstance, &mut Context<'_>) = BlockInstance::call::<standstill_axis::Standard>;

// A host has many instances in a row, so large data is kept elsewhere (tables, the memory of outputs).
const _: () = assert!(size_of::<BlockInstance>() <= 256);

impl AnyInstance for BlockInstance {
    fn info(&self) -> &'static BlockInfo {
        self.any().info()
    }

    fn get(&self, index: usize) -> Option<Value> {
        self.any().get(index)
    }

    fn put_words(&self, words: &mut [u64]) {
        self.any().put_words(words);
    }

    fn set(&mut self, index: usize, value: Value) -> Result<(), PinError> {
        self.any_mut().set(index, value)
    }

    fn set_flat(&mut self, flat: &[u8], pointer: Pointer) {
        self.any_mut().set_flat(flat, pointer);
    }

    fn put_flat(&self, flat: &mut [u8]) {
        self.any().put_flat(flat);
    }
}

/// The block called `name`, without regard to case.
pub fn find(name: &str) -> Option<&'static BlockInfo> {
    REGISTRY.iter().find(|info| info.name.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_fb::{Direction, Group};
    use std::collections::BTreeSet;
    use std::string::ToString;
    use std::vec::Vec;

    #[test]
    fn names_are_unique_and_make_their_own_instances() {
        let names: BTreeSet<_> = REGISTRY
            .iter()
            .map(|info| info.name.to_ascii_uppercase())
            .collect();
        assert_eq!(names.len(), REGISTRY.len());
        for info in REGISTRY {
            let instance = BlockInstance::new(&info.name.to_lowercase()).unwrap();
            assert_eq!(instance.info().name, info.name);
        }
        assert!(BlockInstance::new("MC_Nothing").is_none());
    }

    /// Covers: R3, R7
    #[test]
    fn each_block_begins_with_the_axis_of_its_kind() {
        for info in REGISTRY.iter().filter(|info| info.name.starts_with("MC_")) {
            let in_outs: Vec<_> = info.pins_of(Direction::InOut).collect();
            let of_drive = in_outs
                .iter()
                .any(|pin| matches!(pin.ty.iec_name(), "MC_INPUT_REF" | "MC_OUTPUT_REF"));
            let axes: Vec<_> = in_outs
                .iter()
                .filter(|pin| pin.ty.iec_name() == "AXIS_REF")
                .map(|pin| pin.name)
                .collect();
            // A coupling has its masters first and ends with its slave.
            let expected: &[&[&str]] = match info.group {
                Group::MultiAxis => &[&["Master", "Slave"], &["Master1", "Master2", "Slave"], &["Slave"]],
                // Blocks that read and write inputs and outputs have a reference to those instead; a cam switch has both.
                Group::Administrative if of_drive => &[&[], &["Axis"]],
                Group::Administrative | Group::SingleAxis | Group::Homing | Group::Standard => &[&["Axis"]],
            };
            assert!(expected.contains(&axes.as_slice()), "{}: {axes:?}", info.name);
            let first = in_outs.first().map(|pin| pin.ty.iec_name());
            let is_first = match axes.is_empty() {
                true => matches!(first, Some("MC_INPUT_REF" | "MC_OUTPUT_REF")),
                false => first == Some("AXIS_REF"),
            };
            assert!(is_first, "{}: {first:?}", info.name);
            for pin in info.pins().filter(|pin| !pin.unit.is_empty()) {
                assert_eq!(pin.ty.iec_name(), "LREAL", "{}.{}", info.name, pin.name);
            }
        }
    }

    /// Covers: R84, V8, V8a
    #[test]
    fn enumerations_have_the_stated_numbers_and_prefixed_names() {
        let numbers = |name: &str| -> Vec<i32> {
            match name {
                "MC_BUFFER_MODE" => (0..=5).collect(),
                "MC_DIRECTION" => (0..=4).collect(),
                "MC_SOURCE" | "MC_SYNC_MODE" | "MC_START_MODE" => (0..=2).collect(),
                "MC_EXECUTION_MODE" | "MC_COMBINE_MODE" => (0..=1).collect(),
                "MC_TRIGGER_REF" => (0..=3).collect(),
                _ => panic!("state the numbers of {name} here"),
            }
        };
        for pin in REGISTRY.iter().flat_map(|info| info.pins()) {
            if let standstill_fb::PinType::Enum(info) = pin.ty {
                let found: Vec<_> = info.elements.iter().map(|(_, number)| *number).collect();
                assert_eq!(found, numbers(info.name), "{}", info.name);
                assert!(info.elements.iter().all(|(name, _)| name.starts_with("mc")));
            }
        }
    }

    #[test]
    fn every_pin_reads_back_what_was_written() {
        for info in REGISTRY {
            let mut instance = BlockInstance::new(info.name).unwrap();
            let pins: Vec<_> = info.pins().collect();
            let names: BTreeSet<_> = pins.iter().map(|pin| pin.name.to_string()).collect();
            assert_eq!(names.len(), pins.len(), "{}", info.name);
            for (index, pin) in pins.iter().enumerate() {
                let value = instance.get(index).unwrap();
                assert!(!pin.doc.is_empty(), "{}.{}", info.name, pin.name);
                if index < info.input_count() {
                    assert_eq!(info.default_of(index), Some(value), "{}.{}", info.name, pin.name);
                    assert_eq!(instance.set(index, value), Ok(()));
                } else {
                    assert_eq!(instance.set(index, value), Err(PinError::NotWritable));
                }
            }
            assert_eq!(instance.get(pins.len()), None);
        }
    }

    /// Covers: R87
    #[test]
    fn vendor_pins_come_after_the_standard_pins_of_their_kind() {
        for info in REGISTRY {
            for pair in info.pins().collect::<Vec<_>>().windows(2) {
                if pair[0].direction == pair[1].direction {
                    assert!(
                        pair[0].extension <= pair[1].extension,
                        "{}.{}",
                        info.name,
                        pair[1].name
                    );
                }
            }
        }
    }
}
