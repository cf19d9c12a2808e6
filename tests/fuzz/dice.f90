!> Tests. Pseudo-random numbers that depend on a seed's number and nothing else: L'Ecuyer's combined generator
!> (Communications of the ACM 31, 1988, p. 742), its two states set by squaring, so that neighbouring seeds are unlike.
module dice
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none
   private
   public :: dice_t, new_dice, throw, chance, between, magnitude, disorder

   integer(int64), parameter :: m1 = 2147483563_int64, m2 = 2147483399_int64

   type :: dice_t
      integer(int64) :: a = 1, b = 1
   end type dice_t

contains

   !> The generator of seed number `seed`.
   pure function new_dice(seed) result(d)
      integer, intent(in) :: seed
      type(dice_t) :: d
      integer :: i

      d%a = modulo(int(seed, int64), m1 - 1) + 1
      d%b = modulo(int(seed, int64), m2 - 1) + 1
      do i = 1, 4
         d%a = modulo(modulo(d%a*d%a, m1) + 69621_int64*d%a + i, m1 - 1) + 1
         d%b = modulo(modulo(d%b*d%b, m2) + 48271_int64*d%b + i, m2 - 1) + 1
      end do
   end function new_dice

   !> Between 0 and 1, neither of them.
   real(wp) function share(d)
      type(dice_t), intent(inout) :: d
      integer(int64) :: z

      d%a = modulo(40014_int64*d%a, m1)
      d%b = modulo(40692_int64*d%b, m2)
      z = d%a - d%b
      if (z < 1) z = z + m1 - 1
      share = real(z, wp)/real(m1, wp)
   end function share

   !> 1, 2, ..., n.
   integer function throw(d, n)
      type(dice_t), intent(inout) :: d
      integer, intent(in) :: n

      throw = min(n, 1 + int(share(d)*n))
   end function throw

   !> True in `p` of all cases.
   logical function chance(d, p)
      type(dice_t), intent(inout) :: d
      real(wp), intent(in) :: p

      chance = share(d) < p
   end function chance

   real(wp) function between(d, low, high)
      type(dice_t), intent(inout) :: d
      real(wp), intent(in) :: low, high

      between = low + (high - low)*share(d)
   end function between

   !> 10**-k to 10**k, every power of ten as likely as the next.
   real(wp) function magnitude(d, k)
      type(dice_t), intent(inout) :: d
      integer, intent(in) :: k

      magnitude = 10.0_wp**between(d, -real(k, wp), real(k, wp))
   end function magnitude

   !> 1 to `n` in disorder.
   function disorder(r, n) result(list)
      type(dice_t), intent(inout) :: r
      integer, intent(in) :: n
      integer :: list(n), i, k

      list = [(i, i=1, n)]
      do i = n, 2, -1
         k = throw(r, i)
         list([i, k]) = list([k, i])
      end do
   end function disorder
end module dice
