!> Which tolerances count: of each quantity that PRINT asks for, at the printed instant at which the root of the sum of
!> squares is greatest, the share of each number in the sum of squares, the largest first.
module tolerance_shares
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_pole
   use independent, only: set_t, request_of
   use points, only: is_listed, coordinates_of
   use names, only: subject_name
   use set_motion, only: set_motion_t, spread_t, spread_in_set
   use sensitivities, only: has_tolerances, worst_case, root_of_squares
   use listing_layout, only: layout_t, digits_t, dimension_of, unit_of
   use listing_tables, only: time_text
   use text_output, only: output_t, put
   use numerals, only: fixed, whole
   use extremes, only: column_of, is_angle
   use phrases
   implicit none
   private
   public :: shares_t, note_tolerances, put_shares

   !> A quantity at the instant at which its root of squares is greatest so far.
   type :: share_t
      real(wp) :: root = 0.0_wp, worst = 0.0_wp, t = 0.0_wp
      real(wp), allocatable :: s(:)                 !< (numbers) the sensitivities; not allocated: none was known yet
   end type share_t

   type :: shares_t
      type(share_t), allocatable :: list(:, :, :)   !< (3, 0:2, requests)
      logical, allocatable :: jams(:, :)            !< (numbers, parts) redundant equations leave no room for it
   end type shares_t

   !> Smaller shares are only counted.
   real(wp), parameter :: least_share = 1.0e-4_wp
   integer, parameter :: percent_decimals = 2
   !> Numbers that differ by less than this part are alike: the first counts.
   real(wp), parameter :: alike = max(1.0e-9_wp, 4096.0_wp*epsilon(1.0_wp))
   !> By this part more, what rounding has left below a half is rounded up.
   real(wp), parameter :: half_up = max(1.0e-9_wp, 8.0_wp*epsilon(1.0_wp))
   !> Characters of the name of a number before its sensitivity, unless it is longer.
   integer, parameter :: number_name = 36

contains

   !> Takes the sensitivities of instant number `k`, that of the motions `s`.
   subroutine note_tolerances(a, s, k)
      type(shares_t), intent(inout) :: a
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: k
      type(request_t) :: request
      type(spread_t) :: x
      real(wp) :: root(3, 0:2), worst(3, 0:2)
      integer :: i, n, column, order, c

      if (.not. allocated(a%list)) then
         allocate (a%list(3, 0:2, size(s%rows)))
         allocate (a%jams(maxval([(size(s%parts(c)%tolerances), c=1, s%count)]), s%count), source=.false.)
      end if
      do i = 1, size(s%rows)
         request = request_of(s, i)
         associate (c => s%rows(i)%part)
            if (.not. is_listed(s, request, k) .or. .not. has_tolerances(s%parts(c), request)) cycle
            x = spread_in_set(s, i)
            root = root_of_squares(x%tolerances, x%of)
            worst = worst_case(x%tolerances, x%of)
            do order = 0, x%known
               do column = 1, 3
                  associate (one => a%list(column, order, i))
                     if (allocated(one%s) .and. root(column, order) <= one%root*(1.0_wp + alike)) cycle
                     one%root = root(column, order)
                     one%worst = worst(column, order)
                     one%t = s%motions(1)%t
                     one%s = x%of(column, lbound(x%of, 2) + order, :)
                  end associate
               end do
            end do
            n = size(s%sensitivities(c)%jams)
            a%jams(:n, c) = a%jams(:n, c) .or. s%sensitivities(c)%jams
         end associate
      end do
   end subroutine note_tolerances

   !> Writes the shares after the last instant of the set `s`.
   subroutine put_shares(o, l, a, s)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(shares_t), intent(in) :: a
      class(set_t), intent(in) :: s
      type(request_t) :: request
      integer :: i, c, k, d

      call put(o, '')
      call put(o, ' '//phrase(say_shares, s%polish))
      if (any([(any(s%parts(c)%requests%kind >= request_pole), c=1, s%count)])) &
         call put(o, ' --- '//phrase(say_no_shares, s%polish))
      do c = 1, s%count
         do d = 1, size(s%parts(c)%tolerances)
            if (a%jams(d, c)) &
               call put(o, ' *** '//trim(s%parts(c)%tolerances(d)%name)//': '//phrase(say_jams, s%polish))
         end do
      end do
      do i = 1, size(s%rows)
         request = request_of(s, i)
         associate (part => s%rows(i)%part)
            if (.not. has_tolerances(s%parts(part), request)) cycle
            do k = 0, 2
               do c = merge(3, 1, request%angle_alone), coordinates_of(request%kind)
                  call put_quantity(o, l, l%own(part), s%parts(part), request, c, k, a%list(c, k, i))
               end do
            end do
         end associate
      end do
   end subroutine put_shares

   !> The lines of coordinate `c`, derivative `k`, of the row of `request` of `m`, an independent mechanism, with the
   !> digits `d`; none where the tables have zero.
   subroutine put_quantity(o, l, d, m, request, c, k, share)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: c, k
      type(share_t), intent(in) :: share
      character(:), allocatable :: unit
      integer :: column, coordinate, what, decimals, i
      real(wp), allocatable :: part(:)
      real(wp) :: size_of
      character(12) :: sensitivity
      character(max(number_name, len(m%tolerances%name))) :: name

      if (.not. allocated(share%s)) return
      coordinate = column_of(request, is_angle(m, request, c), c)
      column = l%column(coordinate, k, request%kind)
      what = dimension_of(coordinate)
      size_of = merge(l%angle, 1.0_wp, what == 2)
      decimals = d%decimals(what, k) + l%more_decimals
      if (share%root/size_of < 0.5_wp*10.0_wp**(d%power(what, k) - decimals)) return
      unit = unit_of(d%power(what, k), trim(l%unit(column, request%kind))//trim(l%per(column, request%kind)))
      call put(o, ' '//trim(l%word(request%kind))//' '//trim(subject_name(m, request%kind, request%subject))//'  ' &
         //trim(l%name(column, request%kind))//'   T = '//time_text(l, share%t)//l%behind_time &
         //'   RSS = '//value_text(share%root)//'   '//phrase(say_worst, m%polish)//' = ' &
         //value_text(share%worst)//' '//unit)

      ! A line for each number with a share of note, the largest first: share, name, sensitivity, tolerance.
      part = (share%s*m%tolerances%size_of/share%root)**2
      do while (any(part >= least_share))
         ! Of those that are alike the first one comes first.
         i = findloc(part >= maxval(part)*(1.0_wp - alike), .true., dim=1)
         associate (one => m%tolerances(i))
            write (sensitivity, '(es12.4e3)') share%s(i)/size_of
            name = one%name
            ! A half is rounded up, whatever the last bit.
            call put(o, fixed(100.0_wp*part(i)*(1.0_wp + half_up), percent_decimals, 0)//' %  ' &
               //name(:max(number_name, len_trim(name)))//'  S = '//sensitivity//'   +- '//trim(one%text)//' ' &
               //trim(one%unit_name))
         end associate
         part(i) = -1.0_wp
      end do
      if (any(part >= 0.0_wp)) call put(o, '   '//phrase(say_small_shares, m%polish)//' '//whole(count(part >= 0.0_wp)))

   contains

      !> A value of the quantity.
      function value_text(x) result(text)
         real(wp), intent(in) :: x
         character(:), allocatable :: text

         text = trim(adjustl(fixed(x/size_of, decimals, d%power(what, k))))
      end function value_text
   end subroutine put_quantity
end module tolerance_shares
