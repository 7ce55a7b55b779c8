//! The program on one to four ranks of this machine, against the serial run and by its manners.
//! `KLUFT_SEEDS`, `KLUFT_KILLS` and `KLUFT_STARTS` set how many networks, kills and starts there
//! are.

mod equal;
mod harness;
mod kills;
mod manners;
mod networks;
mod pieces;
