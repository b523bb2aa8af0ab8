//! Name of the shared library for its users' dynamic linker: major and minor version of the package.

fn main() {
    let version = |part| std::env::var(format!("CARGO_PKG_VERSION_{part}")).unwrap_or_default();
    let interface = format!("{}.{}", version("MAJOR"), version("MINOR"));
    match std::env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("linux") => {
            println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libkinopt_c.so.{interface}");
        }
        Ok("macos") => println!(
            "cargo:rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libkinopt_c.{interface}.dylib"
        ),
        _ => {}
    }
}
