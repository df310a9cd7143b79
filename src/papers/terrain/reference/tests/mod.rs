//! The oracle against closed forms and against dense marching.

mod curved;
mod plane;
