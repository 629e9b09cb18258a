//! The tests of `posicast-system`, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod output;
