//! digitise
