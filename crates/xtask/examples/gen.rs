//! Writes every generated file.

use std::fs;

fn main() -> std::io::Result<()> {
    for file in standstill_xtask::generated() {
        let path = standstill_xtask::root().join(&file.path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        if fs::read_to_string(&path).ok().as_deref() != Some(&file.text) {
            fs::write(&path, &file.text)?;
            println!("wrote {}", file.path);
        }
    }
    Ok(())
}
