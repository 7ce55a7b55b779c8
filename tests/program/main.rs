//! The program as its users meet it: the real binary, its messages, its exit codes, its files.

mod adapt;
mod bad_input;
mod book;
mod doubts;
mod examples;
mod harness;
mod inspect;
mod load_paths;
mod network;
mod network_seeds;
mod read_back;
mod renumbered;
mod results;
mod resume;
mod soak;
mod study;
mod talk;
mod usage;
