!> Tests. A kinematic scheme: the links, points, pairs and drives of a deck with its assembly at the first instant, in
!> real128. Each number of the deck is one that a double holds, so that the deck has all its digits.
module schemes
   use, intrinsic :: iso_fortran_env, only: real64
   use quad_jet, only: qp, jet_t, degree_q, operator(+), operator(-), operator(*), sin, cos
   use mechanism, only: drive_angle, drive_relangle, measure_distance, measure_line, measure_angle, measure_sum, &
      term_power, term_table, term_cycloid
   use rise_laws, only: rise_words
   use drive_laws, only: law_t
   implicit none
   private
   public :: scheme_t, link_t, point_t, pair_t, measure_t, drive_t, group_t, body_t
   public :: form_any, form_rrr, form_rrp, form_rpr, form_prp, form_rpp, form_parallelogram
   public :: angle_unit, is_angle, point_on, link_at, place, set_trigonometry, drive_unit, write_scheme, double
   public :: is_redundant

   !> What a group is solved by: closed forms of dyads and of the parallelogram, or Newton's method.
   enum, bind(c)
      enumerator :: form_any, form_rrr, form_rrp, form_rpr, form_prp, form_rpp, form_parallelogram
   end enum

   type :: link_t
      logical :: ground = .false.
      integer :: group = 0                     !< 0: ground
      real(qp) :: at(3) = 0.0_qp               !< x, y, phi (rad) in the assembly of the first instant
      real(qp) :: estimate(3) = 0.0_qp         !< those of the LINK card, phi in rad
      real(qp) :: centre(2) = 0.0_qp           !< joints of further links lie round this place of the assembly,
      real(qp) :: reach = 0.0_qp               !< not farther away than this
   end type link_t

   type :: point_t
      integer :: link = 0
      real(qp) :: offset(2) = 0.0_qp           !< xi, eta
   end type point_t

   type :: pair_t
      logical :: prismatic = .false.
      integer :: point_i = 0, point_j = 0
      real(qp) :: alpha = 0.0_qp, h = 0.0_qp, beta = 0.0_qp !< angles in the deck's unit
   end type pair_t

   character(8), parameter :: measure_cards(measure_sum) = &
      [character(8) :: 'DISTANCE', 'LINE', 'ANGLE', 'XI', 'ETA', 'SUM']

   !> What a card measures: by the kind two points, two links or lines, a point and a link, or two measures.
   type :: measure_t
      integer :: kind = measure_distance
      integer :: subjects(2) = 0
      logical :: of_line(2) = .false.          !< of an angle: a line, otherwise a link
      real(qp) :: factors(2) = 1.0_qp, constant = 0.0_qp   !< of a sum; the constant in the deck's unit
      logical :: is_angle = .false.
   end type measure_t

   type :: drive_t
      integer :: kind = 0, subject = 0, second = 0
      type(law_t) :: law
   end type drive_t

   !> Links that are found together, when those before them are known.
   type :: group_t
      integer :: form = form_any
      integer :: links(2) = 0, pairs(2) = 0, drives(2) = 0 !< first and last
      integer :: part = 0                      !< independent mechanism
      real(qp) :: scale = 1.0_qp               !< a length of its links
      integer, allocatable :: bases(:)         !< links outside that it hangs on
      real(qp) :: side = 1.0_qp                !< which of two assemblies
      logical :: redundant = .false.
      real(qp) :: branch_after = huge(1.0_qp)  !< a BRANCH card's time
   end type group_t

   type :: scheme_t
      integer :: seed = 0
      logical :: degrees = .false.
      type(link_t), allocatable :: links(:)
      type(point_t), allocatable :: points(:)
      type(pair_t), allocatable :: pairs(:)
      type(drive_t), allocatable :: drives(:)
      type(measure_t), allocatable :: measures(:) !< not allocated: none
      type(group_t), allocatable :: groups(:)
      integer :: steps = 0
      real(qp) :: t0 = 0.0_qp, t1 = 0.0_qp
      real(qp) :: span = 1.0_qp                !< of all instants
      real(qp), allocatable :: at(:)           !< instants of AT cards
      character(8) :: method = ''
      character(8) :: print = 'ALL'
      integer, allocatable :: printed(:)       !< links that PRINT cards name; not allocated: all
      integer, allocatable :: link_order(:), point_order(:), pair_order(:)
      integer :: digits = 17                   !< of the numbers in the deck
   end type scheme_t

   !> A link's motion, with cosine and sine of its angle.
   type :: body_t
      type(jet_t) :: x, y, phi, c, s
   end type body_t

contains

   !> The number that a deck has for `x`.
   elemental real(qp) function double(x)
      real(qp), intent(in) :: x

      double = real(real(x, real64), qp)
   end function double

   pure real(qp) function angle_unit(s)
      type(scheme_t), intent(in) :: s

      angle_unit = merge(degree_q, 1.0_qp, s%degrees)
   end function angle_unit

   !> There are more equations than unknowns: of a group, or since the last pair is one of the others once more.
   pure logical function is_redundant(s) result(is)
      type(scheme_t), intent(in) :: s
      integer :: n

      n = size(s%pairs)
      is = any(s%groups%redundant)
      if (n > 0) is = is .or. any(s%pairs(:n - 1)%point_i == s%pairs(n)%point_i &
         .and. s%pairs(:n - 1)%point_j == s%pairs(n)%point_j)
   end function is_redundant

   !> The drive moves an angle, not a length.
   pure logical function is_angle(drive)
      type(drive_t), intent(in) :: drive

      is_angle = drive%kind == drive_angle .or. drive%kind == drive_relangle
   end function is_angle

   !> In radians or lengths: the unit of what `drive` gives.
   pure real(qp) function drive_unit(s, drive)
      type(scheme_t), intent(in) :: s
      type(drive_t), intent(in) :: drive

      drive_unit = merge(angle_unit(s), 1.0_qp, is_angle(drive))
   end function drive_unit

   !> The point of `pair` that lies on `link`.
   pure integer function point_on(s, pair, link)
      type(scheme_t), intent(in) :: s
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: link

      point_on = merge(pair%point_i, pair%point_j, s%points(pair%point_i)%link == link)
   end function point_on

   pure integer function link_at(s, point)
      type(scheme_t), intent(in) :: s
      integer, intent(in) :: point

      link_at = s%points(point)%link
   end function link_at

   elemental subroutine set_trigonometry(b)
      type(body_t), intent(inout) :: b

      b%c = cos(b%phi)
      b%s = sin(b%phi)
   end subroutine set_trigonometry

   !> x and y of the point (xi, eta) of a link.
   pure function place(b, offset) result(p)
      type(body_t), intent(in) :: b
      real(qp), intent(in) :: offset(2)
      type(jet_t) :: p(2)

      p(1) = b%x + (offset(1)*b%c - offset(2)*b%s)
      p(2) = b%y + (offset(1)*b%s + offset(2)*b%c)
   end function place

   !> The cards of `s`, through END, to `unit`.
   subroutine write_scheme(s, unit)
      type(scheme_t), intent(in) :: s
      integer, intent(in) :: unit
      integer :: k, i
      real(qp) :: u

      u = angle_unit(s)
      write (unit, '(a,i0)') 'TITLE   SEED ', s%seed
      write (unit, '(2a)') 'UNITS   M       ', merge('DEG     S', 'RAD     S', s%degrees)
      if (s%method /= '') write (unit, '(2a)') 'METHOD  ', trim(s%method)
      do k = 1, size(s%links)
         i = s%link_order(k)
         if (.not. any(s%points%link == i) .and. .not. any(s%drives%kind == drive_relangle .and. &
            (s%drives%second == i .or. s%drives%subject == i))) cycle
         associate (q => s%links(i)%estimate)
            call card(s%digits, unit, merge('GROUND  ', 'LINK    ', s%links(i)%ground), [name('L', i)], &
               [q(1), q(2), q(3)/u])
         end associate
      end do
      do k = 1, size(s%points)
         i = s%point_order(k)
         call card(s%digits, unit, 'POINT   ', [name('P', i), name('L', s%points(i)%link)], s%points(i)%offset)
      end do
      do k = 1, size(s%pairs)
         i = s%pair_order(k)
         associate (p => s%pairs(i))
            if (p%prismatic) then
               call card(s%digits, unit, 'PRISM   ', [name('P', p%point_i), name('P', p%point_j), name('K', i)], &
                  [p%alpha, p%h, p%beta])
            else
               call card(s%digits, unit, 'REVOLUTE', [name('P', p%point_i), name('P', p%point_j), name('K', i)], &
                  [real(qp) ::])
            end if
         end associate
      end do
      do k = 1, size(s%drives)
         call write_drive(s%drives(k), s%digits, unit)
      end do
      if (allocated(s%measures)) then
         do k = 1, size(s%measures)
            call write_measure(s, s%measures(k), k, unit)
         end do
      end if
      call write_rest(s, unit)
   end subroutine write_scheme

   subroutine write_drive(d, digits, unit)
      type(drive_t), intent(in) :: d
      integer, intent(in) :: digits, unit
      character(8), parameter :: drives(5) = [character(8) :: 'ANGLE', 'X', 'Y', 'RELANGLE', 'SLIDE']
      character(1), parameter :: letters(5) = ['L', 'P', 'P', 'L', 'K'] !< of the names of their subjects
      character(8), parameter :: terms(7) = [character(8) :: 'HARMONIC', 'POWER', 'TABLE', rise_words]
      character(8) :: second
      integer :: k

      second = ''
      if (d%kind == drive_relangle) second = name('L', d%second)
      call card(digits, unit, 'DRIVE', [drives(d%kind), name(letters(d%kind), d%subject), second], d%law%polynomial)
      if (d%law%form == 0) return
      if (d%law%form == term_table) then
         do k = 1, size(d%law%time)
            call card(digits, unit, 'ADD', [terms(term_table)], [d%law%time(k), d%law%value(k)])
         end do
      else
         call card(digits, unit, merge('RISE', 'ADD ', d%law%form >= term_cycloid), [terms(d%law%form)], &
            d%law%r(:merge(2, 3, d%law%form == term_power)))
      end if
   end subroutine write_drive

   !> The card of measure number `k`, with lines that are named M and a number as all measures are.
   subroutine write_measure(s, one, k, unit)
      type(scheme_t), intent(in) :: s
      type(measure_t), intent(in) :: one
      integer, intent(in) :: k, unit
      character(1) :: letters(2)
      real(qp), allocatable :: reals(:)

      select case (one%kind)
      case (measure_distance, measure_line)
         letters = 'P'
      case (measure_angle)
         letters = merge('M', 'L', one%of_line)
      case (measure_sum)
         letters = 'M'
      case default
         letters = ['P', 'L']
      end select
      reals = [real(qp) ::]
      if (one%kind == measure_sum) reals = [one%factors, one%constant]
      call card(s%digits, unit, measure_cards(one%kind), &
         [name(letters(1), one%subjects(1)), name(letters(2), one%subjects(2)), name('M', k)], reals)
   end subroutine write_measure

   !> BRANCH, TIME, AT, PRINT and END.
   subroutine write_rest(s, unit)
      type(scheme_t), intent(in) :: s
      integer, intent(in) :: unit
      character(8) :: text
      integer :: k

      do k = 1, size(s%groups)
         if (s%groups(k)%branch_after < huge(1.0_qp)) &
            call card(s%digits, unit, 'BRANCH  ', [name('L', s%groups(k)%links(1) + 1)], [s%groups(k)%branch_after])
      end do
      write (text, '(i0)') s%steps
      if (s%steps > 0) call card(s%digits, unit, 'TIME    ', [text], [s%t0, s%t1])
      do k = 1, size(s%at)
         call card(s%digits, unit, 'AT      ', [character(8) ::], s%at(k:k))
      end do
      if (allocated(s%printed)) then
         do k = 1, size(s%printed)
            call card(s%digits, unit, 'PRINT   ', ['LINKS   ', name('L', s%printed(k))], [real(qp) ::])
         end do
      else
         write (unit, '(2a)') 'PRINT   ', trim(s%print)
         if (allocated(s%measures) .and. s%print /= 'ALL') write (unit, '(a)') 'PRINT   MEASURES'
      end if
      write (unit, '(a)') 'END'
   end subroutine write_rest

   function name(letter, i)
      character(1), intent(in) :: letter
      integer, intent(in) :: i
      character(8) :: name

      write (name, '(a,i0)') letter, i
   end function name

   !> One card with its labels, and its numbers with so many `digits` on a card of their own.
   subroutine card(digits, unit, what, labels, reals)
      integer, intent(in) :: digits, unit
      character(*), intent(in) :: what, labels(:)
      real(qp), intent(in) :: reals(:)
      character(104) :: line
      character(12) :: form
      integer :: k

      line = what
      do k = 1, size(labels)
         line(8*k + 1:8*k + 8) = labels(k)
      end do
      write (unit, '(a)') trim(line)
      if (size(reals) == 0) return
      line = '*'
      write (form, '(a,i0,a)') '(es24.', digits - 1, 'e3)'
      do k = 1, size(reals)
         write (line(24*k - 15:24*k + 8), form) real(reals(k), real64)
         line(24*k - 15:24*k + 8) = adjustl(line(24*k - 15:24*k + 8))
      end do
      write (unit, '(a)') trim(line)
   end subroutine card
end module schemes
