# Dummies without their meaning: awk -f dummies.awk FILES... prints each declaration of numbers, logicals or text with an
# intent that has no comment `!<`. A dummy of a derived type has the meaning of its type.
!/^ *!/ && /^ *(real|integer|logical|character)[ (,].*intent *[(]/ && !/!</ { print FILENAME ":" FNR ": " $0 }
