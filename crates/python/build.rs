//! Tells linkers that require it that Python provides the undefined symbols.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
