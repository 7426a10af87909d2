#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    poecal_fuzz::targets::histories(data);
});
