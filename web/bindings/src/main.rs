//! JavaScript and TypeScript bindings of a module: `kinopt-web-bindings MODULE.wasm FOLDER`.

use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [module, folder] = &arguments[..] else {
        return told("usage: kinopt-web-bindings MODULE.wasm FOLDER");
    };
    let mut bindings = Bindgen::new();
    // One script for browsers, workers and Node, whose caller passes the location of the module.
    let written = bindings.web(true).and_then(|bindings| {
        bindings
            .input_path(module)
            .out_name("kinopt")
            .typescript(true)
            .omit_default_module_path(true)
            .remove_producers_section(true)
            .remove_name_section(true)
            .generate(folder)
    });
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => told(&format!("{module}: {error:#}")),
    }
}

#[allow(clippy::print_stderr)] // Message of a command.
fn told(message: &str) -> ExitCode {
    eprintln!("{message}");
    ExitCode::FAILURE
}
