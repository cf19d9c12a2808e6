!> Tests. What a deck's cards say, in real128: the doubles of the deck reader taken back to the decimals on the cards,
!> and the laws of the drives, written once more.
module quad_decks
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_t, term_t, drive_angle, drive_relangle, term_harmonic, term_power, &
      term_table
   use quad_jet, only: qp, jet_t, degree_q, time_jet, operator(+), operator(*)
   use jet_drives, only: term_jet
   implicit none
   private
   public :: length, angle, law

contains

   !> The number that the card holds: the decimal of at most 14 digits that the double stands for, or the double.
   real(qp) function length(x)
      real(wp), intent(in) :: x
      character(24) :: text

      write (text, '(es24.13e3)') x
      read (text, *) length
      if (abs(real(length, wp) - x) > 0.0_wp) length = real(x, qp)
   end function length

   !> As `length`, for an angle in radians that may stand on the card in degrees, or be a whole number of degrees.
   real(qp) function angle(m, x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: x
      real(qp), parameter :: few_roundings = 8.0_qp*epsilon(1.0_wp)
      character(24) :: text

      write (text, '(es24.13e3)') real(x, qp)/degree_q
      read (text, *) angle
      if (.not. m%degrees) angle = anint(angle)
      angle = angle*degree_q
      if (abs(angle - x) > few_roundings*abs(x)) angle = length(x)
   end function angle

   real(qp) function number(m, x, turns)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: x
      logical, intent(in) :: turns

      if (turns) then
         number = angle(m, x)
      else
         number = length(x)
      end if
   end function number

   !> The law of a drive, with the deck's decimals.
   type(jet_t) function law(m, drive, t) result(f)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(jet_t) :: time
      logical :: turns
      integer :: i

      time = time_jet(t)
      turns = any(drive%kind == [drive_angle, drive_relangle])
      associate (c => drive%polynomial)
         f = number(m, c(1), turns) + number(m, c(2), turns)*time + 0.5_qp*number(m, c(3), turns)*time*time
      end associate
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         f = f + term_on_card(m, drive%terms(i), turns, t)
      end do
   end function law

   !> A term of a drive with the numbers of its card.
   type(jet_t) function term_on_card(m, term, turns, t) result(f)
      type(mechanism_t), intent(in) :: m
      type(term_t), intent(in) :: term
      logical, intent(in) :: turns
      real(qp), intent(in) :: t
      real(qp), allocatable :: x(:), y(:)
      real(qp) :: r(3)
      integer :: i

      r = 0.0_qp
      allocate (x(0), y(0))
      select case (term%kind)
      case (term_harmonic)
         r = [number(m, term%r(1), turns), angle(m, term%r(2)), angle(m, term%r(3))]
      case (term_power)
         r(:2) = [number(m, term%r(1), turns), length(term%r(2))]
      case (term_table)
         x = [(length(term%table%x(i)), i=1, size(term%table%x))]
         y = [(number(m, term%table%y(i), turns), i=1, size(term%table%y))]
      case default
         r = [length(term%r(1)), length(term%r(2)), number(m, term%r(3), turns)]
      end select
      f = term_jet(term%kind, r, x, y, t)
   end function term_on_card
end module quad_decks
