//! Reading scripts: good ones into the model, bad ones into messages; layout, schema and document.

mod cases;
mod contract;
mod errors;
mod format;
mod schema;
