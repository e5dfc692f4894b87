//! Masks against the oracle.
