//! Reading scripts: good ones into the model, bad ones into messages; layout, schema and document.

mod agreement;
mod cases;
mod contract;
mod document;
mod errors;
mod every_key;
mod expressions;
mod format;
mod include;
mod mutations;
mod programs;
mod schema;
mod texts;
