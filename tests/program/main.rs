//! The program as its users meet it: the real binary, its messages, its exit codes, its files.

mod adapt;
mod bad_input;
mod book;
mod doubled;
mod doubts;
mod examples;
mod harness;
mod inspect;
mod kept_files;
mod load_paths;
mod machine;
mod manners;
mod network;
mod network_seeds;
mod one_answer;
mod pressed_joints;
mod read_back;
mod renumbered;
mod results;
mod resume;
mod soak;
mod strangers;
mod studies;
mod study;
mod talk;
mod usage;
