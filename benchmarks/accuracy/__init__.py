"""How far the engines are from the equation of motion, over random beam motions."""
