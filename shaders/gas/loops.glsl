// Loops that a driver ends: lavapipe gives a shader 65,535 iterations, shared between all its loops and the threads that
// run in step; then every loop ends with the iteration that it is in, without a word. So every loop whose length follows
// from the input, or that stands beside such a one, finds out from its own state, and nothing is kept of what it began.
// Such a loop is left by its condition alone: behind one that has a second way out, what it leaves through that way may
// not be up to date when the driver ends it. Terms of a condition are joined by `all` and `any`: a compiler makes a way out of each
// that `&&` or `||` joins. What is asked behind a loop is a number or a flag that is set under an `if` in it: what follows from others
// may be computed there anew, a turn too far, and what the loop was left by is taken as known.
//
// It asks at its end where it can: lavapipe does what follows a condition also where no thread holds it, `if` or loop, so that a
// loop that asks first goes through its body once more than any thread wants, and through all loops in it. There it also computes
// on for threads that have left a loop: what one that asks at its end leaves behind is set under an `if` in it, or follows from
// numbers without memory being read, or a thread would have what it reads as none.

bool is_cut = false; // a loop of this thread was ended before its end

uint made = 0u; // densities, or steps along a list, of this thread
const uint MOST_MADE = 65536u; // after which a thread, or a way through gas, ends by itself, so that no dispatch is long
