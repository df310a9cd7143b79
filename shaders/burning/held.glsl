// A triangle in the search of what hangs together without those that are to leave.

const uint THERE = 0u;
const uint GONE = 1u;
const uint LEFT_OUT = 2u; // consumed, and there as yet
