"""What `usmbench doctor` looks at, from the serial port to the counts of a revolution."""
