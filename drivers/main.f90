program splitgrain
  implicit none
end program splitgrain
