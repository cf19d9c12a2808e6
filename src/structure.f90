!> Level 3. What can be said of a mechanism from its links, pairs and drives alone, without geometry.
!>
!> (12)  r = 2 (n1 + n2) + 3 n3
!> (13)  s = 3 n - r        (the print subtracts 2 n1 + n2 only)
module structure
   use mechanism, only: mechanism_t, pair_revolute, pair_prismatic
   implicit none
   private
   public :: findings_t, count_freedoms

   type :: findings_t
      integer :: links = 0        !< n, ground links with them
      integer :: ground = 0       !< n3
      integer :: revolute = 0     !< n1
      integer :: prismatic = 0    !< n2
      integer :: coordinates = 0  !< w = 3 n
      integer :: equations = 0    !< r
      integer :: freedoms = 0     !< s
      integer :: drives = 0
   end type findings_t

contains

   !> Counts (12) and (13) of mechanism `m`.
   pure function count_freedoms(m) result(f)
      type(mechanism_t), intent(in) :: m
      type(findings_t) :: f

      f%links = size(m%links)
      f%ground = count(m%links%ground)
      f%revolute = count(m%pairs%kind == pair_revolute)
      f%prismatic = count(m%pairs%kind == pair_prismatic)
      f%coordinates = 3*f%links
      f%equations = 2*(f%revolute + f%prismatic) + 3*f%ground
      f%freedoms = f%coordinates - f%equations
      f%drives = size(m%drives)
   end function count_freedoms
end module structure
